#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "pllit/io/byte_writer.hpp"
#include "pllit/io/livox_custom_msg.hpp"

namespace pllit {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kStamp_ns = 1'650'000'000'250'000'000;

struct Point {
  std::uint32_t offset_ns;
  Eigen::Vector3f position;
  std::uint8_t tag = 0x10;
};

std::vector<std::byte> message(std::int64_t stamp_ns, std::uint64_t timebase_ns, const std::vector<Point>& points) {
  const auto count = static_cast<std::uint32_t>(points.size());
  ByteWriter writer;
  writer.write(std::uint32_t{1}).write(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000));
  writer.write(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000)).write_text("livox_frame");
  writer.write(timebase_ns).write(count).write(std::uint32_t{0}).write(count);
  for (const Point& point : points) {
    writer.write(point.offset_ns);
    for (const float coordinate : point.position) writer.write(coordinate);
    writer.write(std::uint8_t{77}).write(point.tag).write(std::uint8_t{3});
  }
  return writer.take();
}

const std::vector<Point> kTwo = {{50'000'000, {1, 2, 3}}, {4'000'000, {4, 5, 6}}};

TEST(LivoxDecoding, ReadsPointsInTimeOrderFromTheTimebase) {
  const auto decoded = decode_livox_custom_msg(message(kStamp_ns, kStamp_ns - 10'000'000, kTwo));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->scan.start, Time(Duration(kStamp_ns - 10'000'000 + 4'000'000)));
  EXPECT_EQ(decoded->scan.offsets, (std::vector<Duration>{0ns, 46ms}));
  EXPECT_EQ(decoded->scan.points_L[0], Eigen::Vector3f(4, 5, 6));
  EXPECT_EQ(decoded->scan.intensity, (std::vector<float>{77.0f, 77.0f}));
  EXPECT_TRUE(decoded->has_time);
  EXPECT_FALSE(decoded->clocks_differ);
}

TEST(LivoxDecoding, TakesTheHeaderStampWhereTheTimebaseIsZeroOrOfAnotherClock) {
  for (const std::uint64_t timebase_ns :
       {std::uint64_t{0}, std::uint64_t{kStamp_ns} + 1'500'000'000, ~std::uint64_t{0}}) {
    const auto decoded = decode_livox_custom_msg(message(kStamp_ns, timebase_ns, kTwo));
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_TRUE(decoded->clocks_differ);
    EXPECT_EQ(decoded->scan.start, Time(Duration(kStamp_ns + 4'000'000)));
  }
}

TEST(LivoxDecoding, DropsMissingReturnsThirdReturnsAndCertainNoise) {
  const std::vector<Point> points = {{0, {1, 0, 0}, 0x00},           // return 0
                                     {1'000'000, {2, 0, 0}, 0x10},   // return 1
                                     {2'000'000, {3, 0, 0}, 0x20},   // return 2
                                     {3'000'000, {4, 0, 0}, 0x14},   // low intensity: rain, fog, dust
                                     {4'000'000, {5, 0, 0}, 0x11},   // noise by position, high confidence
                                     {5'000'000, {6, 0, 0}, 0x12},   // the same, moderate confidence
                                     {30'000'000, {0, 0, 0}, 0x10},  // no return
                                     {31'000'000, {std::nanf(""), 0, 0}, 0x10}};
  const auto decoded = decode_livox_custom_msg(message(kStamp_ns, kStamp_ns, points));
  ASSERT_TRUE(decoded) << decoded.error().message;
  std::vector<float> kept;
  for (const Eigen::Vector3f& point : decoded->scan.points_L) kept.push_back(point.x());
  EXPECT_EQ(kept, (std::vector<float>{1, 2, 6}));
  EXPECT_EQ(decoded->dropped.noise, 3u);
  EXPECT_EQ(decoded->dropped.zero, 1u);
  EXPECT_EQ(decoded->dropped.not_finite, 1u);
}

TEST(LivoxDecoding, RefusesAnotherLayoutAndEveryCut) {
  const auto whole = message(kStamp_ns, kStamp_ns, kTwo);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(decode_livox_custom_msg(Bytes(whole).first(size))) << size;
  }
  // The first drivers had a uint32 `timestep` behind the timebase.
  const std::size_t behind_timebase = 4 + 8 + 4 + std::string_view("livox_frame").size() + 8;
  auto old = whole;
  old.insert(old.begin() + static_cast<std::ptrdiff_t>(behind_timebase), 4, std::byte{0});
  const auto decoded = decode_livox_custom_msg(old);
  ASSERT_FALSE(decoded);
  EXPECT_THAT(decoded.error().message, testing::HasSubstr("laid out differently"));
}

TEST(LivoxDecoding, RefusesDamagedTimes) {
  EXPECT_FALSE(decode_livox_custom_msg(message(kStamp_ns, kStamp_ns, {{0, {1, 1, 1}}, {4'000'000'000, {1, 1, 1}}})));
}

}  // namespace
}  // namespace pllit
