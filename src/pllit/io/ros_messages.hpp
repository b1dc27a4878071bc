// Decoding of the ROS 1 messages of an IMU and a camera from their serialised bytes.
#pragma once

#include <string>

#include "pllit/base/error.hpp"
#include "pllit/base/time.hpp"
#include "pllit/io/byte_reader.hpp"
#include "pllit/sensor/measurements.hpp"

namespace pllit {

/// std_msgs/Header.
struct RosHeader {
  Time stamp;
  std::string frame_id;
};
RosHeader read_header(ByteReader& reader);

/// sensor_msgs/Imu. Units as recorded (some drivers give g). Errors: cut short, rates or forces that are not finite.
Expected<ImuSample> decode_imu(Bytes message);

/// sensor_msgs/Image: mono8, 8UC1, mono16 and 16UC1 keep their counts; rgb8, bgr8, rgba8 and bgra8 become BGR. Errors:
/// cut short, sizes that contradict each other, other encodings.
Expected<CameraFrame> decode_image(Bytes message);

/// sensor_msgs/CompressedImage with a JPEG or PNG, 16-bit PNGs kept as they came. Errors: other formats, corrupt data.
Expected<CameraFrame> decode_compressed_image(Bytes message);

}  // namespace pllit
