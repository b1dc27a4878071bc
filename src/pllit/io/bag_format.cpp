#include "pllit/io/bag_format.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <format>
#include <memory>

namespace pllit::bag {
namespace {

constexpr std::uint32_t kLargestHeader = 64 * 1024;  // real ones have under 1 KiB; a damaged length may say anything

template <Number T>
std::optional<T> number_of(Bytes value) {
  if (value.size() != sizeof(T)) return std::nullopt;
  return number_from<T>(value.first<sizeof(T)>());
}

std::optional<Time> time_of(Bytes value) {
  ByteReader reader(value);
  const auto seconds = reader.read<std::uint32_t>();
  const auto nanoseconds = reader.read<std::uint32_t>();
  if (!reader.ok() || nanoseconds >= 1'000'000'000) return std::nullopt;
  return time_from_parts(seconds, nanoseconds);
}

std::string text_of(Bytes value) { return {reinterpret_cast<const char*>(value.data()), value.size()}; }

void set_field(Record& record, std::string_view name, Bytes value) {
  if (name == "op") record.op = static_cast<Op>(number_of<std::uint8_t>(value).value_or(0));
  if (name == "conn") record.connection = number_of<std::uint32_t>(value);
  if (name == "time") record.time = time_of(value);
  if (name == "size") record.size = number_of<std::uint32_t>(value);
  if (name == "count") record.count = number_of<std::uint32_t>(value);
  if (name == "conn_count") record.connection_count = number_of<std::uint32_t>(value);
  if (name == "chunk_count") record.chunk_count = number_of<std::uint32_t>(value);
  if (name == "index_pos") record.index_position = number_of<std::uint64_t>(value);
  if (name == "chunk_pos") record.chunk_position = number_of<std::uint64_t>(value);
  if (name == "start_time") record.start_time = time_of(value);
  if (name == "end_time") record.end_time = time_of(value);
  if (name == "topic") record.topic = text_of(value);
  if (name == "compression") record.compression = text_of(value);
  if (name == "encryptor") record.encryptor = text_of(value);
}

/// Fields may come in any order: length, name, '=', value.
std::optional<Record> parse_header(Bytes header) {
  Record record;
  ByteReader reader(header);
  while (reader.ok() && reader.remaining() > 0) {
    const Bytes field = reader.read_block();
    const std::string_view text(reinterpret_cast<const char*>(field.data()), field.size());
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    set_field(record, text.substr(0, equals), field.subspan(equals + 1));
  }
  const bool known = record.op >= Op::message && record.op <= Op::connection;
  if (!reader.ok() || !known) return std::nullopt;
  return record;
}

std::optional<std::uint32_t> length_at(ByteSource& source, std::uint64_t offset) {
  return number_of<std::uint32_t>(source.at(offset, sizeof(std::uint32_t)));
}

Expected<void> decompress_lz4(Bytes data, std::vector<std::byte>& result) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) return failure("lz4 cannot start");
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> guard(context,
                                                                                   &LZ4F_freeDecompressionContext);
  std::size_t read = 0;
  std::size_t written = 0;
  std::size_t hint = 1;
  while (hint != 0) {
    std::size_t in = data.size() - read;
    std::size_t out = result.size() - written;
    hint = LZ4F_decompress(context, result.data() + written, &out, data.data() + read, &in, nullptr);
    if (LZ4F_isError(hint)) return input_error(std::format("lz4 data is damaged: {}", LZ4F_getErrorName(hint)));
    if (in == 0 && out == 0) break;  // neither more input nor more room
    read += in;
    written += out;
  }
  if (hint != 0 || written != result.size()) return input_error("lz4 data has another size than announced");
  return {};
}

Expected<void> decompress_bz2(Bytes data, std::vector<std::byte>& result) {
  auto size = static_cast<unsigned int>(result.size());
  // The interface takes the input as char*, but only reads it.
  char* input = const_cast<char*>(reinterpret_cast<const char*>(data.data()));
  const int code = BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(result.data()), &size, input,
                                              static_cast<unsigned int>(data.size()), 0, 0);
  if (code != BZ_OK) return input_error(std::format("bz2 data is damaged (code {})", code));
  if (size != result.size()) return input_error("bz2 data has another size than announced");
  return {};
}

}  // namespace

std::optional<Record> read_cut_record(ByteSource& source, std::uint64_t offset) {
  const auto header_size = length_at(source, offset);
  if (!header_size || *header_size > kLargestHeader) return std::nullopt;
  const Bytes header = source.at(offset + 4, *header_size);
  if (header.empty()) return std::nullopt;
  std::optional<Record> record = parse_header(header);
  const auto data_size = length_at(source, offset + 4 + *header_size);
  if (!record || !data_size) return std::nullopt;
  record->data_offset = offset + 8 + *header_size;
  record->data_size = *data_size;
  return record;
}

std::optional<Record> read_record(ByteSource& source, std::uint64_t offset, std::uint64_t limit) {
  std::optional<Record> record = read_cut_record(source, offset);
  if (!record || record->end() > std::min(limit, source.size())) return std::nullopt;
  return record;
}

std::optional<Compression> compression_from_name(std::string_view name) {
  if (name.empty() || name == "none") return Compression::none;
  if (name == "bz2") return Compression::bz2;
  if (name == "lz4") return Compression::lz4;
  return std::nullopt;
}

Expected<std::vector<std::byte>> decompress(Bytes data, Compression compression, std::uint32_t size) {
  if (compression == Compression::none) return std::vector<std::byte>(data.begin(), data.end());
  std::vector<std::byte> result(size);
  const auto done = compression == Compression::lz4 ? decompress_lz4(data, result) : decompress_bz2(data, result);
  if (!done) return std::unexpected(done.error());
  return result;
}

}  // namespace pllit::bag
