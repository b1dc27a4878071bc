#include "pllit/io/bag_file.hpp"

#include <algorithm>
#include <cstring>
#include <format>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

namespace pllit::bag {
namespace {

constexpr std::uint32_t kLargestMessage = 256u << 20;          // a larger length is damage
constexpr std::uint32_t kLargestCompressedChunk = 256u << 20;  // likewise; recorders close chunks at 768 KiB
constexpr std::uint32_t kLargestDescription = 16u << 20;       // message definitions, index entries of one chunk

bool starts_with(ByteSource& file, std::string_view text) {
  const Bytes start = file.at(0, std::min<std::uint64_t>(text.size(), file.size()));
  return start.size() == text.size() && std::memcmp(start.data(), text.data(), text.size()) == 0;
}

/// The data of a record that describes others; nothing where its length can only be damage.
Bytes description(ByteSource& bytes, const Record& record) {
  return record.data_size > kLargestDescription ? Bytes{} : bytes.at(record.data_offset, record.data_size);
}

/// The value of one "name=value" field of a connection record's data.
std::string_view field_of(Bytes fields, std::string_view name) {
  ByteReader reader(fields);
  while (reader.ok() && reader.remaining() > 0) {
    const std::string_view field = reader.read_text();
    if (field.size() > name.size() && field.starts_with(name) && field[name.size()] == '=') {
      return field.substr(name.size() + 1);
    }
  }
  return {};
}

void widen(Chunk& chunk, Time time) {
  chunk.start = chunk.counts.empty() ? time : std::min(chunk.start, time);
  chunk.end = chunk.counts.empty() ? time : std::max(chunk.end, time);
}

}  // namespace

Expected<void> BagFile::check_version() {
  const std::string name = path_.string();
  if (file_->size() == 0) return input_error(std::format("'{}' is empty", name));
  if (starts_with(*file_, kVersionLine)) return {};
  if (starts_with(*file_, "SQLite format 3") || starts_with(*file_, "\x89MCAP")) {
    return input_error(
        std::format("'{}' is a ROS 2 recording; convert it to a ROS 1 bag first (rosbags-convert does)", name));
  }
  if (starts_with(*file_, "#ROS")) {
    return input_error(std::format("'{}' is a bag of a version before 2.0; convert it with 'rosbag fix' first", name));
  }
  return input_error(std::format("'{}' is not a ROS 1 bag: it does not start with '#ROSBAG V2.0'", name));
}

Expected<BagFile> BagFile::open(const std::filesystem::path& path) {
  auto file = FileBytes::open(path);
  if (!file) return std::unexpected(file.error());
  BagFile bag(path, std::move(*file));
  if (const auto version = bag.check_version(); !version) return std::unexpected(version.error());
  const auto header = read_record(*bag.file_, kVersionLine.size(), bag.file_->size());
  if (header && !header->encryptor.empty()) {
    return input_error(std::format("'{}' is encrypted ({}); decrypt it first", path.string(), header->encryptor));
  }
  if (!header || !bag.read_index(*header)) bag.salvage();
  if (bag.connections_.empty() || bag.chunks_.empty()) {
    return input_error(std::format("'{}' holds no messages that can be read", path.string()));
  }
  return bag;
}

bool BagFile::read_index(const Record& file_header) {
  const std::uint64_t size = file_->size();
  if (file_header.op != Op::file_header || file_header.index_position.value_or(0) == 0) return false;
  std::uint64_t position = *file_header.index_position;
  while (position < size) {
    const auto record = read_record(*file_, position, size);
    if (!record || !read_index_record(*record)) return false;
    position = record->end();
  }
  return connections_.size() == file_header.connection_count && chunks_.size() == file_header.chunk_count &&
         index_is_consistent();
}

bool BagFile::index_is_consistent() const {
  std::set<std::uint64_t> positions;
  for (const Chunk& chunk : chunks_) {
    if (!positions.insert(chunk.record).second) return false;
    for (const auto& [connection, count] : chunk.counts) {
      if (!connections_.contains(connection)) return false;
    }
  }
  return true;
}

bool BagFile::read_index_record(const Record& record) {
  if (record.op == Op::connection) return add_connection(*file_, record);
  if (record.op != Op::chunk_info || !record.chunk_position || !record.start_time || !record.end_time) return false;
  if (*record.chunk_position >= file_->size() || *record.start_time > *record.end_time) return false;
  if (record.count.value_or(0) * std::uint64_t{8} != record.data_size) return false;
  Chunk chunk{.record = *record.chunk_position, .start = *record.start_time, .end = *record.end_time};
  ByteReader reader(description(*file_, record));
  while (reader.ok() && reader.remaining() > 0) {
    const auto connection = reader.read<std::uint32_t>();
    chunk.counts[connection] += reader.read<std::uint32_t>();
  }
  chunks_.push_back(std::move(chunk));
  return reader.ok();
}

bool BagFile::add_connection(ByteSource& bytes, const Record& record) {
  if (!record.connection) return false;
  const Bytes fields = description(bytes, record);
  Connection connection{.topic = record.topic,
                        .type = std::string(field_of(fields, "type")),
                        .md5 = std::string(field_of(fields, "md5sum"))};
  if (connection.topic.empty() || connection.type.empty()) return false;
  connections_.try_emplace(*record.connection, std::move(connection));
  return true;
}

OpenChunk BagFile::list_messages(std::shared_ptr<ByteSource> bytes, std::uint64_t begin, std::uint64_t end) {
  OpenChunk chunk;
  std::uint64_t position = begin;
  while (position < end && !chunk.damaged) {
    const auto record = read_record(*bytes, position, end);
    if (record && record->op == Op::connection) {
      chunk.damaged = !add_connection(*bytes, *record);
    } else if (record && record->op == Op::message && record->connection && record->time &&
               record->data_size <= kLargestMessage) {
      chunk.messages.push_back({*record->time, *record->connection, record->data_size, record->data_offset});
    } else {
      chunk.damaged = true;
    }
    if (record) position = record->end();
  }
  chunk.bytes = std::move(bytes);
  chunk.end = position;
  return chunk;
}

Expected<void> BagFile::locate(Chunk& chunk) {
  if (chunk.located) return {};
  const auto record = read_record(*file_, chunk.record, file_->size());
  if (!record || record->op != Op::chunk) return input_error("there is no chunk where the index says");
  const auto compression = compression_from_name(record->compression);
  if (!compression) return input_error(std::format("its compression '{}' is not known", record->compression));
  chunk.compression = *compression;
  chunk.data_offset = record->data_offset;
  chunk.data_size = record->data_size;
  chunk.size = record->size.value_or(0);
  chunk.located = true;
  return {};
}

Expected<OpenChunk> BagFile::open_chunk(std::size_t index) {
  Chunk& chunk = chunks_[index];
  const auto where = [&] { return std::format("{}, chunk at byte {}", path_.string(), chunk.record); };
  if (auto located = locate(chunk); !located) return in_context(where(), located.error());
  if (chunk.compression == Compression::none) {
    return list_messages(file_, chunk.data_offset, chunk.data_offset + chunk.data_size);
  }
  if (chunk.size > kLargestCompressedChunk || chunk.data_size > kLargestCompressedChunk) {
    return input_error(std::format("{}: it claims {} bytes; its header is damaged", where(), chunk.size));
  }
  auto data = decompress(file_->at(chunk.data_offset, chunk.data_size), chunk.compression, chunk.size);
  if (!data) return in_context(where(), data.error());
  OpenChunk open = list_messages(std::make_shared<MemoryBytes>(std::move(*data)), 0, chunk.size);
  open.held_bytes = chunk.size;
  return open;
}

void BagFile::salvage() {
  connections_.clear();
  chunks_.clear();
  std::uint64_t position = kVersionLine.size() + kFileHeaderRecordBytes;
  const std::uint64_t size = file_->size();
  while (position < size) {
    const auto record = read_cut_record(*file_, position);
    const std::uint64_t before = position;
    if (record && record->op == Op::chunk && record->data_size > 0) {
      position = salvage_chunk(position, *record);
    } else if (record && record->op == Op::chunk) {
      position = record->data_offset;  // a chunk that was never closed: its records follow bare
    } else if (record && (record->op == Op::message || record->op == Op::connection)) {
      position = salvage_open_end(position);
    } else if (record && record->end() <= size) {
      position = record->end();
    }
    if (position <= before) break;
  }
  std::uint64_t messages = 0;
  for (const Chunk& chunk : chunks_) {
    for (const auto& [connection, count] : chunk.counts) messages += count;
  }
  notes_.push_back(std::format(
      "{} has no complete index (its recorder did not close it, or it was cut off): {} messages were found by "
      "reading through it",
      path_.string(), messages));
  if (position < size) {
    notes_.push_back(std::format("{}: the last {} of {} bytes cannot be read", path_.string(), size - position, size));
  }
}

/// Returns where the next record starts.
std::uint64_t BagFile::salvage_chunk(std::uint64_t position, const Record& record) {
  Chunk chunk{.record = position, .located = true, .data_offset = record.data_offset, .size = record.size.value_or(0)};
  const auto compression = compression_from_name(record.compression);
  const bool whole = record.end() <= file_->size();
  chunk.data_size = whole ? record.data_size : file_->size() - record.data_offset;
  if (!compression) return whole ? record.end() : position;
  chunk.compression = *compression;
  std::uint64_t next = chunk.data_offset + chunk.data_size;
  if (!whole && chunk.compression != Compression::none) return position;  // no part of it decompresses
  if (summarise_from_index(next, chunk) || summarise_from_messages(chunk)) chunks_.push_back(std::move(chunk));
  return next;
}

/// Bare records up to the first unreadable one: what a recorder wrote last before it was killed.
std::uint64_t BagFile::salvage_open_end(std::uint64_t position) {
  const OpenChunk open = list_messages(file_, position, file_->size());
  Chunk chunk{.record = position, .located = true, .data_offset = position};
  for (const MessageRef& message : open.messages) {
    widen(chunk, message.time);
    ++chunk.counts[message.connection];
  }
  chunk.data_size = open.end - position;
  if (!chunk.counts.empty()) chunks_.push_back(std::move(chunk));
  return open.end;
}

/// Takes times and counts from the index records behind a chunk; moves `position` past them. False where there is none,
/// or where it names a connection that has not been seen: then the chunk itself must be read.
bool BagFile::summarise_from_index(std::uint64_t& position, Chunk& chunk) {
  bool complete = true;
  Chunk summary;
  while (const auto record = read_record(*file_, position, file_->size())) {
    if (record->op != Op::index || !record->connection) break;
    ByteReader reader(description(*file_, *record));
    while (reader.remaining() >= 12) {
      const auto seconds = reader.read<std::uint32_t>();
      const auto nanoseconds = reader.read<std::uint32_t>();
      reader.skip(4);  // where in the chunk
      widen(summary, time_from_parts(seconds, nanoseconds));
      ++summary.counts[*record->connection];
    }
    complete = complete && connections_.contains(*record->connection);
    position = record->end();
  }
  if (!complete || summary.counts.empty()) return false;
  chunk.start = summary.start;
  chunk.end = summary.end;
  chunk.counts = std::move(summary.counts);
  return true;
}

bool BagFile::summarise_from_messages(Chunk& chunk) {
  chunks_.push_back(chunk);
  const auto open = open_chunk(chunks_.size() - 1);
  chunks_.pop_back();
  if (!open) {
    notes_.push_back(open.error().message + "; skipped");
    return false;
  }
  for (const MessageRef& message : open->messages) {
    widen(chunk, message.time);
    ++chunk.counts[message.connection];
  }
  return !chunk.counts.empty();
}

}  // namespace pllit::bag
