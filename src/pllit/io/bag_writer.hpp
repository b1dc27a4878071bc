// Writes ROS 1 bags (format 2.0) that ROS tools and other SLAM systems read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/base/time.hpp"
#include "pllit/io/byte_writer.hpp"
#include "pllit/io/ros_encoding.hpp"

namespace pllit {

/// One bag, not compressed. Chunks go to disk whole, so a writer that is killed leaves a bag that can be read up to its
/// last chunk. After an error every later call returns it again. Received times must not lie before 1970.
class BagWriter {
 public:
  static constexpr std::size_t kChunkBytes = 768 * 1024;  ///< rosbag's default

  /// Replaces what is at `path`; chunks are closed when they reach `chunk_bytes`. Errors: it cannot be written.
  static Expected<BagWriter> create(const std::filesystem::path& path, std::size_t chunk_bytes = kChunkBytes);
  BagWriter(BagWriter&&) = default;
  BagWriter& operator=(BagWriter&&) = delete;
  /// Closes; an error is lost, so call close() to learn of it.
  ~BagWriter();

  /// A serialised message of any type.
  Expected<void> write(const std::string& topic, const RosType& type, Time received, Bytes message);

  Expected<void> write_imu(const std::string& topic, Time received, const ImuSample& sample);
  Expected<void> write_scan(const std::string& topic, Time received, const LidarScan& scan,
                            const PointCloud2Layout& layout = {});
  Expected<void> write_livox_scan(const std::string& topic, Time received, const LidarScan& scan);
  Expected<void> write_image(const std::string& topic, Time received, const CameraFrame& frame);

  /// Writes the index. Errors: the disk is full, or anything that went wrong before.
  Expected<void> close();

 private:
  struct Connection {
    std::uint32_t id = 0;
    std::vector<std::byte> record;
  };
  struct IndexEntry {
    Time received;
    std::uint32_t offset = 0;
  };
  struct ChunkInfo {
    std::uint64_t position = 0;
    Time start{};
    Time end{};
    std::map<std::uint32_t, std::uint32_t> counts{};
  };

  BagWriter(std::filesystem::path path, std::ofstream file, std::size_t chunk_bytes)
      : path_(std::move(path)), file_(std::move(file)), chunk_bytes_(chunk_bytes) {}

  const Connection& connection_of(const std::string& topic, const RosType& type);
  void write_file_header(std::uint64_t index_position);
  void write_chunk();
  void write_record(Bytes header, Bytes data);
  Expected<void> status();

  std::filesystem::path path_;
  std::ofstream file_;
  std::size_t chunk_bytes_;
  std::uint64_t position_ = 0;
  std::map<std::string, Connection> connections_;  ///< by topic
  ByteWriter chunk_;
  std::map<std::uint32_t, std::vector<IndexEntry>> chunk_index_;  ///< by connection
  std::vector<ChunkInfo> chunks_;
  std::string problem_;
};

}  // namespace pllit
