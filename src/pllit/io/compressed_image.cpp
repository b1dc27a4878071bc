#include <array>
#include <exception>
#include <format>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "pllit/io/ros_messages.hpp"

namespace pllit {
namespace {

constexpr std::uint64_t kMostPixels = 100'000'000;  // no thermal or visible camera; a damaged header may claim any size

struct Size {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

bool starts_with(Bytes data, std::initializer_list<int> signature) {
  if (data.size() < signature.size()) return false;
  return std::equal(signature.begin(), signature.end(), data.begin(),
                    [](int expected, std::byte byte) { return static_cast<std::byte>(expected) == byte; });
}

/// A PNG starts with its signature and the header chunk (PNG specification, 11.2.2).
std::optional<Size> png_size(Bytes data) {
  if (!starts_with(data, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'})) return std::nullopt;
  ByteReader reader(data.subspan(8), std::endian::big);
  reader.skip(8);  // length and type of the header chunk
  const auto width = reader.read<std::uint32_t>();
  const auto height = reader.read<std::uint32_t>();
  return Size{width, height};
}

/// A JPEG is a chain of marker segments; a start-of-frame segment carries the size (ITU T.81, B.2.2).
std::optional<Size> jpeg_size(Bytes data) {
  if (!starts_with(data, {0xff, 0xd8})) return std::nullopt;
  ByteReader reader(data.subspan(2), std::endian::big);
  while (reader.ok()) {
    const auto marker = reader.read<std::uint16_t>();
    const auto length = reader.read<std::uint16_t>();
    const bool start_of_frame = marker >= 0xffc0 && marker <= 0xffcf && marker != 0xffc4 && marker != 0xffc8 &&
                                marker != 0xffcc;  // the three are tables, not frames
    if (start_of_frame) {
      reader.skip(1);  // sample precision
      const auto height = reader.read<std::uint16_t>();
      const auto width = reader.read<std::uint16_t>();
      return Size{width, height};
    }
    if (marker < 0xffc0 || length < 2) return Size{};
    reader.skip(length - 2u);
  }
  return Size{};
}

std::optional<cv::Mat> decoded(Bytes data) {
  const cv::Mat packed(1, static_cast<int>(data.size()), CV_8UC1,
                       const_cast<std::byte*>(data.data()));  // only read; cv::Mat has no view of constant data
  try {
    cv::Mat image = cv::imdecode(packed, cv::IMREAD_UNCHANGED);
    if (!image.empty()) return image;
  } catch (const std::exception&) {
    // OpenCV throws on some kinds of damage and returns nothing on others; both mean the same here.
  }
  return std::nullopt;
}

}  // namespace

Expected<CameraFrame> decode_compressed_image(Bytes message) {
  ByteReader reader(message);
  const Time stamp = read_header(reader).stamp;
  const std::string format(reader.read_text());
  const Bytes data = reader.read_block();
  if (!reader.ok()) return input_error(std::format("CompressedImage message of {} bytes is cut short", message.size()));
  std::optional<Size> size = png_size(data);
  if (!size) size = jpeg_size(data);
  if (!size) {
    return input_error(std::format("CompressedImage with format '{}' is neither a JPEG nor a PNG", format));
  }
  const std::uint64_t pixels = std::uint64_t{size->width} * size->height;
  if (pixels == 0 || pixels > kMostPixels) {
    return input_error(
        std::format("CompressedImage claims {} x {} pixels; its data is damaged", size->width, size->height));
  }
  std::optional<cv::Mat> image = decoded(data);
  if (!image) return input_error(std::format("CompressedImage ('{}', {} bytes) does not decode", format, data.size()));
  if (image->type() == CV_8UC4) cv::cvtColor(*image, *image, cv::COLOR_BGRA2BGR);
  if (image->type() != CV_8UC1 && image->type() != CV_16UC1 && image->type() != CV_8UC3) {
    return input_error(
        std::format("CompressedImage ('{}') has {} channels of {} bytes; 8-bit grey, 16-bit grey or 8-bit "
                    "colour is needed",
                    format, image->channels(), image->elemSize1()));
  }
  return CameraFrame{.time = stamp, .counts = *image};
}

}  // namespace pllit
