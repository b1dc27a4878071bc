// Serialised clouds of any layout, and small bags in a folder of their own.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "pllit/io/bag_writer.hpp"
#include "pllit/io/byte_writer.hpp"
#include "pllit/sensor/measurements.hpp"
#include "support/temporary_folder.hpp"

namespace pllit::test {

using CloudNumber = std::variant<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t, std::uint32_t,
                                 float, double, std::int64_t, std::uint64_t>;

/// A column of a cloud: the datatype is that of its numbers, which all have one type.
struct CloudColumn {
  std::string name;
  std::vector<CloudNumber> values;
  std::uint8_t datatype = 0;   ///< 0: that of the numbers
  std::uint32_t elements = 1;  ///< as announced
};

/// A sensor_msgs/PointCloud2 message before it is serialised.
struct CloudMessage {
  Time stamp{};
  std::vector<CloudColumn> columns{};
  std::uint32_t height = 1;
  std::uint32_t point_padding = 0;  ///< bytes behind each point
  std::uint32_t row_padding = 0;    ///< bytes behind each row
  bool big_endian = false;
  bool is_dense = true;
};

std::vector<std::byte> serialised(const CloudMessage& message);

/// Float32 columns x, y, z of `count` points on a line: (1 + i, 2, 3).
std::vector<CloudColumn> points_on_a_line(std::size_t count);

template <class T>
CloudColumn column(std::string name, const std::vector<T>& values) {
  return {.name = std::move(name), .values = std::vector<CloudNumber>(values.begin(), values.end())};
}

/// A recording of `duration_s`: 100 Hz IMU on /imu, 10 Hz scans of 50 points on /points, 20 Hz 8x6 16-bit images on
/// /thermal/image. Everything is received 5 ms after its stamp (scans: after their end).
struct SampleRecording {
  Time start = Time(std::chrono::seconds(1'700'000'000));
  double duration_s = 2.0;
  bool with_images = true;
};
std::vector<SensorEvent> sample_events(const SampleRecording& recording);
void write_bag(const std::filesystem::path& path, const std::vector<SensorEvent>& events,
               std::size_t chunk_bytes = BagWriter::kChunkBytes);

/// Every byte of a file.
std::vector<char> contents(const std::filesystem::path& path);
void write_contents(const std::filesystem::path& path, const std::vector<char>& bytes);

}  // namespace pllit::test
