#include "pllit/io/ros_messages.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <format>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string_view>

namespace pllit {
namespace {

Eigen::Vector3d read_vector3(ByteReader& reader) {
  const auto x = reader.read<double>();
  const auto y = reader.read<double>();
  const auto z = reader.read<double>();
  return {x, y, z};
}

constexpr std::size_t kQuaternionBytes = 4 * sizeof(double);
constexpr std::size_t kCovarianceBytes = 9 * sizeof(double);

struct Encoding {
  std::string_view name;
  int type;
  int to_bgr;  ///< OpenCV's conversion code, or kAsItIs
};
constexpr int kAsItIs = -1;
constexpr std::array kEncodings = {Encoding{"mono8", CV_8UC1, kAsItIs},
                                   Encoding{"8UC1", CV_8UC1, kAsItIs},
                                   Encoding{"mono16", CV_16UC1, kAsItIs},
                                   Encoding{"16UC1", CV_16UC1, kAsItIs},
                                   Encoding{"bgr8", CV_8UC3, kAsItIs},
                                   Encoding{"8UC3", CV_8UC3, kAsItIs},
                                   Encoding{"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
                                   Encoding{"bgra8", CV_8UC4, cv::COLOR_BGRA2BGR},
                                   Encoding{"rgba8", CV_8UC4, cv::COLOR_RGBA2BGR}};

struct RawImage {
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::endian order = std::endian::little;
  std::size_t step = 0;
  Bytes data;
};

std::optional<std::string> inconsistency(const RawImage& image, const Encoding& encoding) {
  const std::size_t row = image.width * static_cast<std::size_t>(CV_ELEM_SIZE(encoding.type));
  if (image.width == 0 || image.height == 0) return "it is empty";
  if (image.step < row) return std::format("step {} is less than a row of {} bytes", image.step, row);
  if (row > image.data.size() || image.height - 1 > (image.data.size() - row) / image.step) {
    return std::format("{} rows of {} bytes do not fit into {} bytes of data", image.height, image.step,
                       image.data.size());
  }
  return std::nullopt;
}

cv::Mat counts_of(const RawImage& raw, const Encoding& encoding) {
  cv::Mat counts(static_cast<int>(raw.height), static_cast<int>(raw.width), encoding.type);
  const std::size_t row_bytes = raw.width * counts.elemSize();
  for (int row = 0; row < counts.rows; ++row) {
    std::memcpy(counts.ptr(row), raw.data.subspan(row * raw.step, row_bytes).data(), row_bytes);
  }
  if (counts.depth() == CV_16U && raw.order != std::endian::native) {
    std::for_each(counts.begin<std::uint16_t>(), counts.end<std::uint16_t>(),
                  [](std::uint16_t& count) { count = std::byteswap(count); });
  }
  if (encoding.to_bgr == kAsItIs) return counts;
  cv::Mat bgr;
  cv::cvtColor(counts, bgr, encoding.to_bgr);
  return bgr;
}

}  // namespace

RosHeader read_header(ByteReader& reader) {
  reader.skip(sizeof(std::uint32_t));  // seq
  const auto seconds = reader.read<std::uint32_t>();
  const auto nanoseconds = reader.read<std::uint32_t>();
  return {.stamp = time_from_parts(seconds, nanoseconds), .frame_id = std::string(reader.read_text())};
}

Expected<ImuSample> decode_imu(Bytes message) {
  ByteReader reader(message);
  ImuSample sample{.time = read_header(reader).stamp};
  reader.skip(kQuaternionBytes + kCovarianceBytes);
  sample.gyro_rps = read_vector3(reader);
  reader.skip(kCovarianceBytes);
  sample.accel_mps2 = read_vector3(reader);
  reader.skip(kCovarianceBytes);
  if (!reader.ok()) return input_error(std::format("Imu message of {} bytes is cut short", message.size()));
  if (!sample.gyro_rps.allFinite() || !sample.accel_mps2.allFinite()) {
    return input_error("Imu message holds a rate or force that is not finite");
  }
  return sample;
}

Expected<CameraFrame> decode_image(Bytes message) {
  ByteReader reader(message);
  const Time stamp = read_header(reader).stamp;
  RawImage raw;
  raw.height = reader.read<std::uint32_t>();
  raw.width = reader.read<std::uint32_t>();
  const std::string_view name = reader.read_text();
  raw.order = reader.read<std::uint8_t>() != 0 ? std::endian::big : std::endian::little;
  raw.step = reader.read<std::uint32_t>();
  raw.data = reader.read_block();
  if (!reader.ok()) return input_error(std::format("Image message of {} bytes is cut short", message.size()));
  const auto encoding = std::ranges::find(kEncodings, name, &Encoding::name);
  if (encoding == kEncodings.end()) {
    return input_error(
        std::format("Image encoding '{}' is not known; known are mono8, mono16, 8UC1, 16UC1, bgr8, rgb8, "
                    "bgra8, rgba8",
                    name));
  }
  if (const auto problem = inconsistency(raw, *encoding)) return input_error("Image message: " + *problem);
  return CameraFrame{.time = stamp, .counts = counts_of(raw, *encoding)};
}

}  // namespace pllit
