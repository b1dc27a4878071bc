#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "pllit/io/byte_writer.hpp"
#include "pllit/io/ros_encoding.hpp"
#include "pllit/io/ros_messages.hpp"

namespace pllit {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

const Time kStamp{1'650'000'000'123'456'789ns};

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

cv::Mat random_image(int type) {
  cv::Mat image(7, 5, type);
  cv::RNG random(1);
  random.fill(image, cv::RNG::UNIFORM, 0, image.depth() == CV_16U ? 16384 : 256);
  return image;
}

/// An Image message with rows `step` bytes apart, padding filled with 0xee.
std::vector<std::byte> image_message(const cv::Mat& counts, std::string_view encoding, std::uint32_t padding = 0,
                                     bool big_endian = false) {
  const auto row = static_cast<std::uint32_t>(counts.cols * counts.elemSize());
  ByteWriter data;
  for (int y = 0; y < counts.rows; ++y) {
    std::vector<std::byte> bytes(row + padding, std::byte{0xee});
    std::memcpy(bytes.data(), counts.ptr(y), row);
    if (big_endian) {
      for (std::size_t i = 0; i + 1 < row; i += 2) std::swap(bytes[i], bytes[i + 1]);
    }
    data.write_bytes(bytes);
  }
  ByteWriter writer;
  writer.write(std::uint32_t{0})
      .write(std::uint32_t{1'650'000'000})
      .write(std::uint32_t{123'456'789})
      .write_text("cam");
  writer.write(static_cast<std::uint32_t>(counts.rows)).write(static_cast<std::uint32_t>(counts.cols));
  writer.write_text(encoding)
      .write(static_cast<std::uint8_t>(big_endian))
      .write(row + padding)
      .write_block(data.bytes());
  return writer.take();
}

std::vector<std::byte> file_bytes(const cv::Mat& image, const std::string& extension) {
  std::vector<std::uint8_t> file;
  cv::imencode(extension, image, file);
  const auto bytes = std::as_bytes(std::span(file));
  return {bytes.begin(), bytes.end()};
}

TEST(ImuDecoding, ReturnsWhatWasEncoded) {
  const ImuSample sample{kStamp, {0.1, -0.2, 0.3}, {1.0, 2.0, 9.8}};
  const auto message = encode_imu(sample, "imu");
  const auto decoded = decode_imu(message);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->time, kStamp);
  EXPECT_EQ(decoded->gyro_rps, sample.gyro_rps);
  EXPECT_EQ(decoded->accel_mps2, sample.accel_mps2);
  for (std::size_t size = 0; size < message.size(); ++size) EXPECT_FALSE(decode_imu(Bytes(message).first(size)));
}

TEST(ImuDecoding, RefusesNumbersThatAreNotFinite) {
  EXPECT_FALSE(decode_imu(encode_imu({kStamp, {std::nan(""), 0, 0}, {0, 0, 9.8}}, "imu")));
  EXPECT_FALSE(decode_imu(encode_imu({kStamp, {0, 0, 0}, {0, INFINITY, 9.8}}, "imu")));
}

TEST(ImageDecoding, KeepsGreyCountsOfEightAndSixteenBitsAsTheyCame) {
  for (const auto& [encoding, type] :
       {std::pair{"mono8", CV_8UC1}, {"8UC1", CV_8UC1}, {"mono16", CV_16UC1}, {"16UC1", CV_16UC1}, {"bgr8", CV_8UC3}}) {
    for (const std::uint32_t padding : {0u, 6u}) {
      const cv::Mat image = random_image(type);
      const auto frame = decode_image(image_message(image, encoding, padding));
      ASSERT_TRUE(frame) << frame.error().message;
      EXPECT_EQ(frame->time, kStamp);
      EXPECT_TRUE(same(frame->counts, image)) << encoding;
    }
  }
}

TEST(ImageDecoding, ReadsBigEndianSixteenBits) {
  const cv::Mat image = random_image(CV_16UC1);
  const auto frame = decode_image(image_message(image, "mono16", 4, true));
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_TRUE(same(frame->counts, image));
}

TEST(ImageDecoding, TurnsEveryColourOrderIntoBgr) {
  const cv::Mat bgr = random_image(CV_8UC3);
  std::vector<cv::Mat> planes;
  cv::split(bgr, planes);
  const cv::Mat alpha(bgr.size(), CV_8UC1, cv::Scalar(255));
  cv::Mat rgb, rgba, bgra;
  cv::merge(std::vector{planes[2], planes[1], planes[0]}, rgb);
  cv::merge(std::vector{planes[2], planes[1], planes[0], alpha}, rgba);
  cv::merge(std::vector{planes[0], planes[1], planes[2], alpha}, bgra);
  for (const auto& [encoding, image] : {std::pair{"rgb8", rgb}, {"rgba8", rgba}, {"bgra8", bgra}}) {
    const auto frame = decode_image(image_message(image, encoding));
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_TRUE(same(frame->counts, bgr)) << encoding;
  }
}

TEST(ImageDecoding, ReturnsWhatWasEncoded) {
  for (const int type : {CV_8UC1, CV_16UC1, CV_8UC3}) {
    const CameraFrame frame{kStamp, random_image(type)};
    const auto message = encode_image(frame, "cam");
    const auto decoded = decode_image(message);
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(decoded->time, kStamp);
    EXPECT_TRUE(same(decoded->counts, frame.counts));
    for (std::size_t size = 0; size < message.size(); ++size) EXPECT_FALSE(decode_image(Bytes(message).first(size)));
  }
}

TEST(ImageDecoding, NamesAnUnknownEncodingAndRefusesSizesThatContradictEachOther) {
  const auto unknown = decode_image(image_message(random_image(CV_8UC1), "bayer_rggb8"));
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("'bayer_rggb8'"));
  const auto short_rows = decode_image(image_message(random_image(CV_8UC1), "mono16"));
  ASSERT_FALSE(short_rows);
  EXPECT_THAT(short_rows.error().message, HasSubstr("step 5 is less than a row of 10 bytes"));
}

TEST(CompressedImageDecoding, KeepsPngCountsOfEightAndSixteenBits) {
  for (const int type : {CV_8UC1, CV_16UC1, CV_8UC3}) {
    const cv::Mat image = random_image(type);
    const auto frame =
        decode_compressed_image(encode_compressed_image(kStamp, "png", file_bytes(image, ".png"), "cam"));
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->time, kStamp);
    EXPECT_TRUE(same(frame->counts, image));
  }
}

TEST(CompressedImageDecoding, DecodesJpegInGreyAndColour) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const cv::Mat image(64, 80, type, cv::Scalar(30, 90, 200));
    const auto frame =
        decode_compressed_image(encode_compressed_image(kStamp, "jpeg", file_bytes(image, ".jpg"), "cam"));
    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->counts.type(), type);
    EXPECT_LE(cv::norm(frame->counts, image, cv::NORM_INF), 3.0);
  }
}

TEST(CompressedImageDecoding, RefusesOtherFormatsAndDamage) {
  const auto bitmap =
      decode_compressed_image(encode_compressed_image(kStamp, "bmp", file_bytes(random_image(CV_8UC1), ".bmp"), "cam"));
  ASSERT_FALSE(bitmap);
  EXPECT_THAT(bitmap.error().message, HasSubstr("neither a JPEG nor a PNG"));
  for (const std::string extension : {".png", ".jpg"}) {
    const auto file = file_bytes(cv::Mat(64, 80, CV_8UC1, cv::Scalar(100)), extension);
    for (const std::size_t size : {std::size_t{0}, std::size_t{3}, std::size_t{20}, std::size_t{40}}) {
      const auto cut = std::vector(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_FALSE(decode_compressed_image(encode_compressed_image(kStamp, "x", cut, "cam"))) << extension << size;
    }
  }
}

TEST(CompressedImageDecoding, RefusesAHeaderThatClaimsAGiganticImage) {
  auto file = file_bytes(random_image(CV_8UC1), ".png");
  file[16] = std::byte{0x00};  // width, big-endian
  file[17] = std::byte{0x0f};
  file[20] = std::byte{0x00};  // height
  file[21] = std::byte{0x0f};
  const auto frame = decode_compressed_image(encode_compressed_image(kStamp, "png", file, "cam"));
  ASSERT_FALSE(frame);
  EXPECT_THAT(frame.error().message, HasSubstr("claims 983045 x 983047 pixels"));
}

}  // namespace
}  // namespace pllit
