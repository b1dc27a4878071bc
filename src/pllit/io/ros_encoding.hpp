// Serialised ROS 1 messages from our values, with the names, checksums and definitions that other ROS tools ask for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pllit/io/byte_reader.hpp"
#include "pllit/io/point_time.hpp"
#include "pllit/sensor/measurements.hpp"

namespace pllit {

/// A ROS message type: its name, the MD5 sum of its definition, and the definition with those of the types in it.
struct RosType {
  std::string_view name;
  std::string_view md5;
  std::string_view definition;
};

extern const RosType kImuType;
extern const RosType kPointCloud2Type;
extern const RosType kImageType;
extern const RosType kCompressedImageType;
extern const RosType kLivoxCustomMsgType;   ///< of livox_ros_driver
extern const RosType kLivoxCustomMsg2Type;  ///< of livox_ros_driver2

std::vector<std::byte> encode_imu(const ImuSample& sample, std::string_view frame_id);

struct PointCloud2Layout {
  enum class TimeField {
    time,      ///< float32, offset from the header stamp, as the Velodyne driver writes it
    timestamp  ///< float64, absolute seconds, as the Hesai driver writes it
  };
  TimeField time_field = TimeField::time;
  TimeUnit time_unit = TimeUnit::seconds;  ///< of `time`; FAST-LIO2 and FAST-LIVO2 want microseconds
};

/// Fields x, y, z, intensity (float32), the time and ring (uint16, zeros where the scan has none); header stamp = start
/// of the scan.
std::vector<std::byte> encode_point_cloud2(const LidarScan& scan, std::string_view frame_id,
                                           const PointCloud2Layout& layout = {});

/// Reflectivity is the intensity, rounded and kept within 0 to 255; tag 0x10 (first return), timebase = start.
std::vector<std::byte> encode_livox_custom_msg(const LidarScan& scan, std::string_view frame_id);

/// CV_8UC1 as mono8, CV_16UC1 as mono16, CV_8UC3 as bgr8.
std::vector<std::byte> encode_image(const CameraFrame& frame, std::string_view frame_id);

/// `data` is a whole JPEG or PNG file, `format` what to call it.
std::vector<std::byte> encode_compressed_image(Time stamp, std::string_view format, Bytes data,
                                               std::string_view frame_id);

}  // namespace pllit
