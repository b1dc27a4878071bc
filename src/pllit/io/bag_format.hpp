// The ROS 1 bag format, version 2.0: records of a header with named fields and data (wiki.ros.org/Bags/Format/2.0).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/base/time.hpp"
#include "pllit/io/byte_source.hpp"

namespace pllit::bag {

inline constexpr std::string_view kVersionLine = "#ROSBAG V2.0\n";
/// The file header record is padded so that the first chunk lies at one place in every bag.
inline constexpr std::uint64_t kFileHeaderRecordBytes = 4 + 4 + 4096;

enum class Op : std::uint8_t { message = 2, file_header = 3, index = 4, chunk = 5, chunk_info = 6, connection = 7 };
enum class Compression { none, bz2, lz4 };

/// One record: the header fields that its kind has, and where its data lies.
struct Record {
  Op op{};
  std::optional<std::uint32_t> connection;
  std::optional<std::uint32_t> count;             ///< entries of an index, connections of a chunk info
  std::optional<std::uint32_t> size;              ///< of a chunk's data once decompressed
  std::optional<std::uint32_t> connection_count;  ///< in the whole file
  std::optional<std::uint32_t> chunk_count;       ///< in the whole file
  std::optional<std::uint64_t> index_position;
  std::optional<std::uint64_t> chunk_position;
  std::optional<Time> time;
  std::optional<Time> start_time;
  std::optional<Time> end_time;
  std::string topic;
  std::string compression;
  std::string encryptor;
  std::uint64_t data_offset = 0;
  std::uint32_t data_size = 0;

  std::uint64_t end() const { return data_offset + data_size; }
};

/// The record at `offset`, its header checked, its data within `limit` (one past the last byte); nothing otherwise.
std::optional<Record> read_record(ByteSource& source, std::uint64_t offset, std::uint64_t limit);
/// The same for a record whose data may be cut off by the end of the source.
std::optional<Record> read_cut_record(ByteSource& source, std::uint64_t offset);

std::optional<Compression> compression_from_name(std::string_view name);

/// Errors: damaged data, or data of another size than `size`. Allocates at most `size` bytes, which must be plausible.
Expected<std::vector<std::byte>> decompress(Bytes data, Compression compression, std::uint32_t size);

}  // namespace pllit::bag
