#include "pllit/io/ros_encoding.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "pllit/io/byte_writer.hpp"

namespace pllit {
namespace {

constexpr std::uint8_t kUint16 = 4;  // sensor_msgs/PointField
constexpr std::uint8_t kFloat32 = 7;
constexpr std::uint8_t kFloat64 = 8;
constexpr std::uint8_t kFirstReturn = 0x10;  // Livox tag

ByteWriter& write_header(ByteWriter& writer, Time stamp, std::string_view frame_id) {
  const std::int64_t since_epoch_ns = nanoseconds_of(stamp);
  return writer.write(std::uint32_t{0})
      .write(static_cast<std::uint32_t>(since_epoch_ns / 1'000'000'000))
      .write(static_cast<std::uint32_t>(since_epoch_ns % 1'000'000'000))
      .write_text(frame_id);
}

void write_vector(ByteWriter& writer, const Eigen::Vector3d& vector) {
  for (int axis = 0; axis < 3; ++axis) writer.write(vector[axis]);
}

/// ROS's way of saying that a quantity is not given: -1 in the covariance's first place.
void write_covariance(ByteWriter& writer, double first) {
  writer.write(first);
  for (int i = 1; i < 9; ++i) writer.write(0.0);
}

void write_field(ByteWriter& writer, std::string_view name, std::uint32_t offset, std::uint8_t datatype) {
  writer.write_text(name).write(offset).write(datatype).write(std::uint32_t{1});
}

double units_per_second(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::seconds:
      return 1.0;
    case TimeUnit::milliseconds:
      return 1e3;
    case TimeUnit::microseconds:
      return 1e6;
    case TimeUnit::nanoseconds:
      return 1e9;
  }
  return 1.0;
}

std::string_view encoding_of(int type) { return type == CV_8UC1 ? "mono8" : type == CV_16UC1 ? "mono16" : "bgr8"; }

}  // namespace

std::vector<std::byte> encode_imu(const ImuSample& sample, std::string_view frame_id) {
  ByteWriter writer;
  write_header(writer, sample.time, frame_id);
  for (const double component : {0.0, 0.0, 0.0, 1.0}) writer.write(component);
  write_covariance(writer, -1.0);  // no orientation
  write_vector(writer, sample.gyro_rps);
  write_covariance(writer, 0.0);
  write_vector(writer, sample.accel_mps2);
  write_covariance(writer, 0.0);
  return writer.take();
}

std::vector<std::byte> encode_point_cloud2(const LidarScan& scan, std::string_view frame_id,
                                           const PointCloud2Layout& layout) {
  const bool absolute = layout.time_field == PointCloud2Layout::TimeField::timestamp;
  const std::uint32_t time_bytes = absolute ? 8 : 4, point_step = 16 + time_bytes + 2;
  assert(scan.rings.empty() || scan.rings.size() == scan.points_L.size());
  const auto count = static_cast<std::uint32_t>(scan.points_L.size());
  ByteWriter writer;
  writer.reserve(256 + std::size_t{count} * point_step);
  write_header(writer, scan.start, frame_id);
  writer.write(std::uint32_t{1}).write(count).write(std::uint32_t{6});
  write_field(writer, "x", 0, kFloat32);
  write_field(writer, "y", 4, kFloat32);
  write_field(writer, "z", 8, kFloat32);
  write_field(writer, "intensity", 12, kFloat32);
  write_field(writer, absolute ? "timestamp" : "time", 16, absolute ? kFloat64 : kFloat32);
  write_field(writer, "ring", 16 + time_bytes, kUint16);
  writer.write(std::uint8_t{0}).write(point_step).write(count * point_step).write(count * point_step);
  const double scale = units_per_second(layout.time_unit), start_s = to_seconds(scan.start.time_since_epoch());
  for (std::size_t i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) writer.write(scan.points_L[i][axis]);
    writer.write(scan.intensity[i]);
    const double offset_s = to_seconds(scan.offsets[i]);
    if (absolute)
      writer.write(start_s + offset_s);
    else
      writer.write(static_cast<float>(offset_s * scale));
    writer.write(scan.rings.empty() ? std::uint16_t{0} : scan.rings[i]);
  }
  writer.write(std::uint8_t{1});  // is_dense
  return writer.take();
}

std::vector<std::byte> encode_livox_custom_msg(const LidarScan& scan, std::string_view frame_id) {
  const auto count = static_cast<std::uint32_t>(scan.points_L.size());
  ByteWriter writer;
  writer.reserve(64 + std::size_t{count} * 19);
  write_header(writer, scan.start, frame_id);
  writer.write(static_cast<std::uint64_t>(nanoseconds_of(scan.start))).write(count);
  writer.write(std::uint32_t{0}).write(count);  // lidar_id and reserved bytes, then the length of the array
  for (std::size_t i = 0; i < count; ++i) {
    writer.write(static_cast<std::uint32_t>(scan.offsets[i].count()));
    for (int axis = 0; axis < 3; ++axis) writer.write(scan.points_L[i][axis]);
    const float reflectivity = std::clamp(std::round(scan.intensity[i]), 0.0f, 255.0f);
    writer.write(static_cast<std::uint8_t>(reflectivity)).write(kFirstReturn);
    writer.write(static_cast<std::uint8_t>(scan.rings.empty() ? 0 : scan.rings[i]));
  }
  return writer.take();
}

std::vector<std::byte> encode_image(const CameraFrame& frame, std::string_view frame_id) {
  const cv::Mat& counts = frame.counts;
  const auto row_bytes = static_cast<std::uint32_t>(counts.cols * counts.elemSize());
  ByteWriter writer;
  writer.reserve(64 + counts.rows * std::size_t{row_bytes});
  write_header(writer, frame.time, frame_id);
  writer.write(static_cast<std::uint32_t>(counts.rows)).write(static_cast<std::uint32_t>(counts.cols));
  writer.write_text(encoding_of(counts.type()));
  writer.write(static_cast<std::uint8_t>(std::endian::native == std::endian::big)).write(row_bytes);
  writer.write(counts.rows * row_bytes);
  for (int row = 0; row < counts.rows; ++row) {
    writer.write_bytes(std::as_bytes(std::span(counts.ptr<std::uint8_t>(row), row_bytes)));
  }
  return writer.take();
}

std::vector<std::byte> encode_compressed_image(Time stamp, std::string_view format, Bytes data,
                                               std::string_view frame_id) {
  ByteWriter writer;
  write_header(writer, stamp, frame_id).write_text(format).write_block(data);
  return writer.take();
}

}  // namespace pllit
