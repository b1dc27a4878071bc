#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>

#include "io/sweep.hpp"

namespace pllit {
namespace {

using namespace std::chrono_literals;
using namespace test;
using ::testing::HasSubstr;

TEST(PointTimeDecoding, ReadsVelodyneSecondsAfterTheStamp) {
  const auto decoded = decode_point_cloud2(
      serialised(sweep("time", [](std::int64_t ns) { return static_cast<float>(static_cast<double>(ns) * 1e-9); })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp, 4);  // float32 resolves 7 ns at 0.1 s
  EXPECT_EQ(decoded->time_layout->unit, TimeUnit::seconds);
  EXPECT_EQ(decoded->time_layout->field, "time");
  EXPECT_EQ(decoded->time_layout->datatype, "float32");
  EXPECT_FALSE(decoded->time_layout->absolute);
  EXPECT_TRUE(decoded->time_layout->unit_is_certain);
}

TEST(PointTimeDecoding, ReadsVelodyneSecondsBeforeTheStamp) {
  const auto decoded = decode_point_cloud2(serialised(
      sweep("time", [](std::int64_t ns) { return static_cast<float>(static_cast<double>(ns - 100'000'000) * 1e-9); })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp - 100ms, 8);
}

TEST(PointTimeDecoding, ReadsFastLioMicroseconds) {
  const auto decoded = decode_point_cloud2(
      serialised(sweep("time", [](std::int64_t ns) { return static_cast<float>(static_cast<double>(ns) * 1e-3); })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp, 4);
  EXPECT_EQ(decoded->time_layout->unit, TimeUnit::microseconds);
}

TEST(PointTimeDecoding, ReadsMilliseconds) {
  const auto decoded = decode_point_cloud2(
      serialised(sweep("offset_time", [](std::int64_t ns) { return static_cast<double>(ns) * 1e-6; })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp, 0);
  EXPECT_EQ(decoded->time_layout->unit, TimeUnit::milliseconds);
}

TEST(PointTimeDecoding, ReadsOusterNanoseconds) {
  const auto decoded =
      decode_point_cloud2(serialised(sweep("t", [](std::int64_t ns) { return static_cast<std::uint32_t>(ns); })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp, 0);
  EXPECT_EQ(decoded->time_layout->unit, TimeUnit::nanoseconds);
}

TEST(PointTimeDecoding, ReadsHesaiAbsoluteSecondsAsFineAsFloat64HoldsThem) {
  const std::int64_t start_ns = nanoseconds_of(kStamp);
  const auto decoded = decode_point_cloud2(
      serialised(sweep("timestamp", [&](std::int64_t ns) { return static_cast<double>((start_ns + ns) * 1e-9L); })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp, 240);  // half a step of float64 at 1.65e9 s, at both ends
  EXPECT_TRUE(decoded->time_layout->absolute);
  EXPECT_EQ(decoded->time_layout->unit, TimeUnit::seconds);
}

TEST(PointTimeDecoding, TurnsFloat64SecondsIntoTheNearestNanosecond) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> today(1.6e9, 1.8e9);
  for (int i = 0; i < 1000; ++i) {
    const double seconds = today(random);
    const auto nanoseconds = to_nanoseconds(seconds, TimeUnit::seconds);
    ASSERT_TRUE(nanoseconds);
    // A float64 of this size is a whole number of 2^-22 s, so the comparison can be exact.
    const auto steps = static_cast<std::int64_t>(std::ldexp(seconds, 22));
    EXPECT_EQ(*nanoseconds / 1'000'000'000, steps >> 22);
    const std::int64_t fraction_steps = steps & ((1 << 22) - 1);
    EXPECT_LE(std::abs((*nanoseconds % 1'000'000'000 << 22) - fraction_steps * 1'000'000'000), 1 << 21);
  }
  EXPECT_EQ(to_nanoseconds(-0.25, TimeUnit::seconds), -250'000'000);
  EXPECT_FALSE(to_nanoseconds(std::nan(""), TimeUnit::seconds));
  EXPECT_FALSE(to_nanoseconds(1e10, TimeUnit::seconds));
  EXPECT_FALSE(to_nanoseconds(1e300, TimeUnit::nanoseconds));
}

TEST(PointTimeDecoding, ReadsAbsoluteNanosecondsInIntegersAndInDoubles) {
  const std::int64_t start_ns = nanoseconds_of(kStamp);
  const auto as_integer = [&](std::int64_t ns) { return static_cast<std::uint64_t>(start_ns + ns); };
  const auto integers = decode_point_cloud2(serialised(sweep("timestamp", as_integer)));
  ASSERT_TRUE(integers) << integers.error().message;
  expect_sweep(*integers, kStamp, 0);

  CloudMessage pairs = sweep("timestamp", as_integer);  // two uint32 announced, as some drivers do
  pairs.columns.back().datatype = 6;
  pairs.columns.back().elements = 2;
  const auto pair = decode_point_cloud2(serialised(pairs));
  ASSERT_TRUE(pair) << pair.error().message;
  expect_sweep(*pair, kStamp, 0);

  const auto doubles = decode_point_cloud2(
      serialised(sweep("timestamp", [&](std::int64_t ns) { return static_cast<double>(start_ns + ns); })));
  ASSERT_TRUE(doubles) << doubles.error().message;
  expect_sweep(*doubles, kStamp, 256);
  EXPECT_EQ(doubles->time_layout->unit, TimeUnit::nanoseconds);
}

TEST(PointTimeDecoding, KnowsTheUnitOfAbsoluteTimeEvenInAShortScan) {
  CloudMessage message{.stamp = kStamp, .columns = points_on_a_line(3)};
  const auto start = static_cast<double>(nanoseconds_of(kStamp));
  message.columns.push_back(column<double>("timestamp", {start, start + 1e5, start + 2e5}));
  const auto decoded = decode_point_cloud2(serialised(message));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->time_layout->unit, TimeUnit::nanoseconds);
  EXPECT_NEAR(to_seconds(decoded->scan.offsets.back()), 2e-4, 1e-6);
}

TEST(PointTimeDecoding, RefusesAbsoluteTimeInFloat32) {
  const std::int64_t start_ns = nanoseconds_of(kStamp);
  for (const double unit : {1e-9, 1e-6, 1e-3, 1.0}) {
    const auto decoded = decode_point_cloud2(serialised(sweep(
        "timestamp", [&](std::int64_t ns) { return static_cast<float>(static_cast<double>(start_ns + ns) * unit); })));
    ASSERT_FALSE(decoded) << unit;
    EXPECT_EQ(decoded.error().kind, Error::Kind::input);
    EXPECT_THAT(decoded.error().message, HasSubstr("'timestamp' holds absolute time in float32"));
  }
  // Seconds since the LiDAR was switched on: float32 keeps steps of 0.5 ms at 2 h.
  const auto uptime = decode_point_cloud2(serialised(
      sweep("time", [](std::int64_t ns) { return static_cast<float>(7200.0 + static_cast<double>(ns) * 1e-9); })));
  ASSERT_FALSE(uptime);
  EXPECT_THAT(uptime.error().message, HasSubstr("float32"));
}

TEST(PointTimeDecoding, TakesTheHeaderStampWhereTheLidarHasAClockOfItsOwn) {
  const auto decoded = decode_point_cloud2(
      serialised(sweep("timestamp", [](std::int64_t ns) { return 7200.0 + static_cast<double>(ns) * 1e-9; })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE(decoded->clocks_differ);
  expect_sweep(*decoded, kStamp, 2);
}

TEST(PointTimeDecoding, ShiftsByASweepWhereTheStampIsItsEnd) {
  const auto message = serialised(sweep("t", [](std::int64_t ns) { return static_cast<std::uint32_t>(ns); }));
  const auto decoded = decode_point_cloud2(message, {.stamp_at_scan_end = true});
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp - 100ms, 0);
}

TEST(PointTimeDecoding, TakesTheLastPointForTheEndOfTheSweepWhereTheFirstOnesAreInvalid) {
  CloudMessage message{.stamp = kStamp, .columns = points_on_a_line(3)};
  message.columns[0].values[0] = std::nanf("");
  message.columns.push_back(column<std::uint32_t>("t", {0, 40'000'000, 100'000'000}));
  const auto decoded = decode_point_cloud2(serialised(message), {.stamp_at_scan_end = true});
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->scan.start, kStamp - 60ms);
  EXPECT_EQ(decoded->scan.end(), kStamp);
}

TEST(PointTimeDecoding, SaysWhereNoPointTimeIsToBeHad) {
  CloudMessage message{.stamp = kStamp, .columns = points_on_a_line(200)};
  const auto without = decode_point_cloud2(serialised(message));
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_FALSE(without->has_time);
  EXPECT_FALSE(without->time_layout);
  EXPECT_EQ(without->scan.start, kStamp);
  EXPECT_EQ(without->scan.end(), kStamp);

  message.columns.push_back(column("time", std::vector<float>(200, 0.0f)));
  const auto filler = decode_point_cloud2(serialised(message));
  ASSERT_TRUE(filler) << filler.error().message;
  EXPECT_FALSE(filler->has_time);
  EXPECT_EQ(filler->scan.end(), kStamp);
}

TEST(PointTimeDecoding, TakesTheUnitItIsGivenAndRefusesSpansThatFitNone) {
  const auto slow =
      serialised(sweep("time", [](std::int64_t ns) { return static_cast<double>(ns) * 1e-7; }));  // 10 units
  const auto refused = decode_point_cloud2(slow);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("--set input.lidar_time_unit="));
  const auto given = decode_point_cloud2(slow, {.time_unit = TimeUnit::milliseconds});
  ASSERT_TRUE(given) << given.error().message;
  EXPECT_EQ(given->scan.offsets.back(), 10ms);
  EXPECT_FALSE(decode_point_cloud2(slow, {.time_unit = TimeUnit::seconds}));
}

}  // namespace
}  // namespace pllit
