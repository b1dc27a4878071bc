#include "pllit/io/bag_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <format>
#include <span>

#include "pllit/io/bag_format.hpp"

namespace pllit {
namespace {

using bag::Op;

constexpr std::uint32_t kIndexVersion = 1;

/// A record header: fields as length, name, '=', value.
class Header {
 public:
  explicit Header(Op op) { field("op", static_cast<std::uint8_t>(op)); }
  template <Number T>
  Header& field(std::string_view name, T value) {
    ByteWriter bytes;
    bytes.write(value);
    return field(name, bytes.bytes());
  }
  Header& field(std::string_view name, Time time) { return field(name, ros_time(time)); }
  Header& field(std::string_view name, std::string_view text) { return field(name, std::as_bytes(std::span(text))); }
  Header& field(std::string_view name, Bytes value) {
    writer_.write(static_cast<std::uint32_t>(name.size() + 1 + value.size()));
    writer_.write_bytes(std::as_bytes(std::span(name))).write('=').write_bytes(value);
    return *this;
  }
  const std::vector<std::byte>& bytes() const { return writer_.bytes(); }

  static std::vector<std::byte> ros_time(Time time) {
    ByteWriter writer;
    writer.write(static_cast<std::uint32_t>(nanoseconds_of(time) / 1'000'000'000));
    writer.write(static_cast<std::uint32_t>(nanoseconds_of(time) % 1'000'000'000));
    return writer.take();
  }

 private:
  ByteWriter writer_;
};

std::vector<std::byte> connection_record(std::uint32_t id, const std::string& topic, const RosType& type) {
  const Header header = Header(Op::connection).field("conn", id).field("topic", std::string_view(topic));
  ByteWriter data;  // itself a sequence of fields
  const auto add = [&](std::string_view name, std::string_view value) {
    data.write_text(std::string(name) + "=" + std::string(value));
  };
  add("topic", topic);
  add("type", type.name);
  add("md5sum", type.md5);
  add("message_definition", type.definition);
  ByteWriter record;
  record.write_block(header.bytes()).write_block(data.bytes());
  return record.take();
}

}  // namespace

Expected<BagWriter> BagWriter::create(const std::filesystem::path& path, std::size_t chunk_bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file) return failure(std::format("'{}' cannot be written: {}", path.string(), std::strerror(errno)));
  BagWriter writer(path, std::move(file), chunk_bytes);
  writer.write_file_header(0);
  if (auto ready = writer.status(); !ready) return std::unexpected(ready.error());
  return writer;
}

BagWriter::~BagWriter() {
  if (file_.is_open()) static_cast<void>(close());
}

Expected<void> BagWriter::status() {
  if (problem_.empty() && !file_) {
    problem_ = std::format("'{}' cannot be written: {}", path_.string(), std::strerror(errno));
  }
  if (!problem_.empty()) return failure(problem_);
  return {};
}

void BagWriter::write_record(Bytes header, Bytes data) {
  ByteWriter lengths;
  lengths.write_block(header).write(static_cast<std::uint32_t>(data.size()));
  const auto put = [&](Bytes bytes) {
    file_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    position_ += bytes.size();
  };
  put(lengths.bytes());
  put(data);
}

void BagWriter::write_file_header(std::uint64_t index_position) {
  file_.seekp(0);
  file_ << bag::kVersionLine;
  position_ = bag::kVersionLine.size();
  const Header header = Header(Op::file_header)
                            .field("index_pos", index_position)
                            .field("conn_count", static_cast<std::uint32_t>(connections_.size()))
                            .field("chunk_count", static_cast<std::uint32_t>(chunks_.size()));
  const std::size_t padding = bag::kFileHeaderRecordBytes - 8 - header.bytes().size();
  write_record(header.bytes(), std::vector<std::byte>(padding, std::byte{' '}));
}

const BagWriter::Connection& BagWriter::connection_of(const std::string& topic, const RosType& type) {
  const auto [entry, is_new] = connections_.try_emplace(topic);
  if (is_new) {
    const auto id = static_cast<std::uint32_t>(connections_.size() - 1);
    entry->second = {.id = id, .record = connection_record(id, topic, type)};
    chunk_.write_bytes(entry->second.record);
  }
  return entry->second;
}

Expected<void> BagWriter::write(const std::string& topic, const RosType& type, Time received, Bytes message) {
  if (auto ready = status(); !ready) return ready;
  if (!file_.is_open()) return failure(std::format("'{}' is already closed", path_.string()));
  if (received < Time{})
    return failure(std::format("'{}': a message of {} was received before 1970", path_.string(), topic));
  const std::uint32_t id = connection_of(topic, type).id;
  chunk_index_[id].push_back({received, static_cast<std::uint32_t>(chunk_.size())});
  const Header header = Header(Op::message).field("conn", id).field("time", received);
  chunk_.write_block(header.bytes()).write_block(message);
  if (chunk_.size() >= chunk_bytes_) write_chunk();
  return status();
}

void BagWriter::write_chunk() {
  if (chunk_index_.empty()) return;
  ChunkInfo info{.position = position_, .start = chunk_index_.begin()->second.front().received};
  info.end = info.start;
  const Header chunk_header = Header(Op::chunk)
                                  .field("compression", std::string_view("none"))
                                  .field("size", static_cast<std::uint32_t>(chunk_.size()));
  write_record(chunk_header.bytes(), chunk_.bytes());
  for (const auto& [id, entries] : chunk_index_) {
    ByteWriter data;
    for (const IndexEntry& entry : entries) {
      data.write_bytes(Header::ros_time(entry.received)).write(entry.offset);
      info.start = std::min(info.start, entry.received);
      info.end = std::max(info.end, entry.received);
    }
    info.counts[id] = static_cast<std::uint32_t>(entries.size());
    const Header header =
        Header(Op::index).field("ver", kIndexVersion).field("conn", id).field("count", info.counts[id]);
    write_record(header.bytes(), data.bytes());
  }
  chunks_.push_back(std::move(info));
  chunk_ = ByteWriter();
  chunk_index_.clear();
}

Expected<void> BagWriter::close() {
  if (!file_.is_open()) return status();
  write_chunk();
  const std::uint64_t index_position = position_;
  for (const auto& [topic, connection] : connections_) {
    file_.write(reinterpret_cast<const char*>(connection.record.data()),
                static_cast<std::streamsize>(connection.record.size()));
  }
  for (const ChunkInfo& chunk : chunks_) {
    ByteWriter data;
    for (const auto& [id, count] : chunk.counts) data.write(id).write(count);
    const Header header = Header(Op::chunk_info)
                              .field("ver", kIndexVersion)
                              .field("chunk_pos", chunk.position)
                              .field("start_time", chunk.start)
                              .field("end_time", chunk.end)
                              .field("count", static_cast<std::uint32_t>(chunk.counts.size()));
    write_record(header.bytes(), data.bytes());
  }
  if (file_) write_file_header(index_position);
  file_.flush();
  auto result = status();
  file_.close();
  return result;
}

Expected<void> BagWriter::write_imu(const std::string& topic, Time received, const ImuSample& sample) {
  return write(topic, kImuType, received, encode_imu(sample, "imu"));
}

Expected<void> BagWriter::write_scan(const std::string& topic, Time received, const LidarScan& scan,
                                     const PointCloud2Layout& layout) {
  return write(topic, kPointCloud2Type, received, encode_point_cloud2(scan, "lidar", layout));
}

Expected<void> BagWriter::write_livox_scan(const std::string& topic, Time received, const LidarScan& scan) {
  return write(topic, kLivoxCustomMsgType, received, encode_livox_custom_msg(scan, "lidar"));
}

Expected<void> BagWriter::write_image(const std::string& topic, Time received, const CameraFrame& frame) {
  return write(topic, kImageType, received, encode_image(frame, "camera"));
}

}  // namespace pllit
