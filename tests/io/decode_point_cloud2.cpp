#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "pllit/io/point_cloud2.hpp"
#include "support/bag_fixtures.hpp"

namespace pllit {
namespace {

using namespace std::chrono_literals;
using test::CloudMessage;
using test::column;
using test::points_on_a_line;
using test::serialised;
using ::testing::HasSubstr;

constexpr std::size_t kCount = 1001;  // one point every 100 us, a sweep of 0.1 s
const Time kStamp{1'650'000'000'123'456'789ns};

std::vector<std::int64_t> true_offsets_ns() {
  std::vector<std::int64_t> offsets(kCount);
  for (std::size_t i = 0; i < kCount; ++i) offsets[i] = static_cast<std::int64_t>(i) * 100'000;
  return offsets;
}

/// The sweep with a time column made by `convert(offset_ns)`.
template <class Convert>
CloudMessage sweep(const std::string& name, const Convert& convert) {
  CloudMessage message{.stamp = kStamp, .columns = points_on_a_line(kCount)};
  std::vector<decltype(convert(std::int64_t{}))> times;
  for (const std::int64_t offset_ns : true_offsets_ns()) times.push_back(convert(offset_ns));
  message.columns.push_back(column(name, times));
  return message;
}

void expect_sweep(const DecodedScan& decoded, Time start, std::int64_t tolerance_ns) {
  ASSERT_EQ(decoded.scan.points_L.size(), kCount);
  EXPECT_TRUE(decoded.has_time);
  EXPECT_LE(std::abs((decoded.scan.start - start).count()), tolerance_ns);
  EXPECT_EQ(decoded.scan.offsets.front(), 0ns);
  const auto offsets_ns = true_offsets_ns();
  for (std::size_t i = 0; i < kCount; ++i) {
    EXPECT_LE(std::abs(decoded.scan.offsets[i].count() - offsets_ns[i]), tolerance_ns) << i;
    EXPECT_EQ(decoded.scan.points_L[i].x(), 1.0f + static_cast<float>(i));
  }
}

TEST(PointCloudDecoding, ReadsVelodyneSecondsAfterTheStamp) {
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

TEST(PointCloudDecoding, ReadsVelodyneSecondsBeforeTheStamp) {
  const auto decoded = decode_point_cloud2(serialised(
      sweep("time", [](std::int64_t ns) { return static_cast<float>(static_cast<double>(ns - 100'000'000) * 1e-9); })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp - 100ms, 8);
}

TEST(PointCloudDecoding, ReadsFastLioMicroseconds) {
  const auto decoded = decode_point_cloud2(
      serialised(sweep("time", [](std::int64_t ns) { return static_cast<float>(static_cast<double>(ns) * 1e-3); })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp, 4);
  EXPECT_EQ(decoded->time_layout->unit, TimeUnit::microseconds);
}

TEST(PointCloudDecoding, ReadsMilliseconds) {
  const auto decoded = decode_point_cloud2(
      serialised(sweep("offset_time", [](std::int64_t ns) { return static_cast<double>(ns) * 1e-6; })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp, 0);
  EXPECT_EQ(decoded->time_layout->unit, TimeUnit::milliseconds);
}

TEST(PointCloudDecoding, ReadsOusterNanoseconds) {
  const auto decoded =
      decode_point_cloud2(serialised(sweep("t", [](std::int64_t ns) { return static_cast<std::uint32_t>(ns); })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp, 0);
  EXPECT_EQ(decoded->time_layout->unit, TimeUnit::nanoseconds);
}

TEST(PointCloudDecoding, ReadsHesaiAbsoluteSecondsAsFineAsFloat64HoldsThem) {
  const std::int64_t start_ns = nanoseconds_of(kStamp);
  const auto decoded = decode_point_cloud2(
      serialised(sweep("timestamp", [&](std::int64_t ns) { return static_cast<double>((start_ns + ns) * 1e-9L); })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp, 240);  // half a step of float64 at 1.65e9 s, at both ends
  EXPECT_TRUE(decoded->time_layout->absolute);
  EXPECT_EQ(decoded->time_layout->unit, TimeUnit::seconds);
}

TEST(PointCloudDecoding, TurnsFloat64SecondsIntoTheNearestNanosecond) {
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

TEST(PointCloudDecoding, ReadsAbsoluteNanosecondsInIntegersAndInDoubles) {
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

TEST(PointCloudDecoding, KnowsTheUnitOfAbsoluteTimeEvenInAShortScan) {
  CloudMessage message{.stamp = kStamp, .columns = points_on_a_line(3)};
  const auto start = static_cast<double>(nanoseconds_of(kStamp));
  message.columns.push_back(column<double>("timestamp", {start, start + 1e5, start + 2e5}));
  const auto decoded = decode_point_cloud2(serialised(message));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->time_layout->unit, TimeUnit::nanoseconds);
  EXPECT_NEAR(to_seconds(decoded->scan.offsets.back()), 2e-4, 1e-6);
}

TEST(PointCloudDecoding, RefusesAbsoluteTimeInFloat32) {
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

TEST(PointCloudDecoding, TakesTheHeaderStampWhereTheLidarHasAClockOfItsOwn) {
  const auto decoded = decode_point_cloud2(
      serialised(sweep("timestamp", [](std::int64_t ns) { return 7200.0 + static_cast<double>(ns) * 1e-9; })));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE(decoded->clocks_differ);
  expect_sweep(*decoded, kStamp, 2);
}

TEST(PointCloudDecoding, ShiftsByASweepWhereTheStampIsItsEnd) {
  const auto message = serialised(sweep("t", [](std::int64_t ns) { return static_cast<std::uint32_t>(ns); }));
  const auto decoded = decode_point_cloud2(message, {.stamp_at_scan_end = true});
  ASSERT_TRUE(decoded) << decoded.error().message;
  expect_sweep(*decoded, kStamp - 100ms, 0);
}

TEST(PointCloudDecoding, SortsByTimeAndKeepsEachPointWithItsTimeAndIntensity) {
  std::vector<std::uint32_t> times(kCount);
  std::iota(times.begin(), times.end(), 0u);
  for (std::uint32_t& time : times) time = time / 2 * 200'000;  // pairs of equal times
  std::mt19937 random(3);
  std::ranges::shuffle(times, random);
  std::vector<std::uint16_t> intensity(times.begin(), times.end());
  CloudMessage message{.stamp = kStamp, .columns = points_on_a_line(kCount)};
  message.columns.push_back(column("t", times));
  message.columns.push_back(column("reflectivity", intensity));
  const auto decoded = decode_point_cloud2(serialised(message));
  ASSERT_TRUE(decoded) << decoded.error().message;
  const LidarScan& scan = decoded->scan;
  EXPECT_TRUE(std::ranges::is_sorted(scan.offsets));
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto place = static_cast<std::size_t>(scan.points_L[i].x() - 1.0f);
    EXPECT_EQ(scan.offsets[i].count(), times[place]);
    EXPECT_EQ(scan.intensity[i], static_cast<float>(intensity[place]));
    if (i > 0 && scan.offsets[i] == scan.offsets[i - 1]) {
      EXPECT_LT(scan.points_L[i - 1].x(), scan.points_L[i].x());
    }
  }
}

TEST(PointCloudDecoding, ReadsOrganisedPaddedAndBigEndianCloudsAlike) {
  CloudMessage message{.stamp = kStamp, .columns = points_on_a_line(60)};
  std::vector<double> times(60);
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = to_seconds(kStamp) + static_cast<double>(i) * 1e-3;
  message.columns.push_back(column("timestamp", times));
  message.columns.push_back(column("intensity", std::vector<std::uint8_t>(60, 9)));
  const auto plain = decode_point_cloud2(serialised(message));
  ASSERT_TRUE(plain) << plain.error().message;
  for (const bool big_endian : {false, true}) {
    for (const std::uint32_t row_padding : {0u, 5u}) {
      message.height = 4;
      message.point_padding = 3;
      message.row_padding = row_padding;
      message.big_endian = big_endian;
      const auto decoded = decode_point_cloud2(serialised(message));
      ASSERT_TRUE(decoded) << decoded.error().message;
      EXPECT_EQ(decoded->scan.start, plain->scan.start);
      EXPECT_EQ(decoded->scan.points_L, plain->scan.points_L);
      EXPECT_EQ(decoded->scan.offsets, plain->scan.offsets);
      EXPECT_EQ(decoded->scan.intensity, plain->scan.intensity);
    }
  }
}

TEST(PointCloudDecoding, ReadsCoordinatesOfAnyNumberType) {
  CloudMessage message{.columns = {column<double>("x", {1.5, 2.5}), column<std::int16_t>("y", {-3, 4}),
                                   column<float>("z", {5.0f, 6.0f})}};
  const auto decoded = decode_point_cloud2(serialised(message));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->scan.points_L[0], Eigen::Vector3f(1.5f, -3.0f, 5.0f));
}

TEST(PointCloudDecoding, DropsAndCountsInvalidPointsWhateverIsDenseClaims) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const bool is_dense : {false, true}) {
    CloudMessage message{.stamp = kStamp,
                         .columns = {column<float>("x", {1, nan, 0, infinity, 0, 2}),
                                     column<float>("y", {1, 0, 0, 0, 0, 2}), column<float>("z", {1, 0, 0, 0, -0.0f, 2}),
                                     column<double>("time", {0.0, 0.01, 0.02, 0.03, 0.04, std::nan("")})},
                         .is_dense = is_dense};
    const auto decoded = decode_point_cloud2(serialised(message));
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(decoded->scan.points_L.size(), 1u);
    EXPECT_EQ(decoded->dropped.not_finite, 2u);
    EXPECT_EQ(decoded->dropped.zero, 2u);
    EXPECT_EQ(decoded->dropped.bad_time, 1u);
  }
}

TEST(PointCloudDecoding, CountsOffsetsFromTheFirstPointThatStays) {
  CloudMessage message{.stamp = kStamp, .columns = points_on_a_line(3)};
  message.columns[0].values[0] = std::numeric_limits<float>::quiet_NaN();
  message.columns.push_back(column<std::uint32_t>("t", {0, 40'000'000, 90'000'000}));
  const auto decoded = decode_point_cloud2(serialised(message));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->scan.start, kStamp + 40ms);
  EXPECT_EQ(decoded->scan.offsets, (std::vector<Duration>{0ns, 50ms}));
}

TEST(PointCloudDecoding, SaysWhereNoPointTimeIsToBeHad) {
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

TEST(PointCloudDecoding, TakesTheUnitItIsGivenAndRefusesSpansThatFitNone) {
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

TEST(PointCloudDecoding, NamesTheFieldsThatAreThereWhenOneIsMissing) {
  CloudMessage message{.columns = {column<float>("x", {1}), column<double>("y", {1}), column<float>("depth", {1})}};
  const auto decoded = decode_point_cloud2(serialised(message));
  ASSERT_FALSE(decoded);
  EXPECT_THAT(decoded.error().message, HasSubstr("no field 'z'"));
  EXPECT_THAT(decoded.error().message, HasSubstr("x (float32), y (float64), depth (float32)"));
}

TEST(PointCloudDecoding, AcceptsAScanWithoutPoints) {
  CloudMessage message{.stamp = kStamp, .columns = points_on_a_line(1)};
  message.columns[0].values[0] = std::numeric_limits<float>::quiet_NaN();
  const auto decoded = decode_point_cloud2(serialised(message));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE(decoded->scan.points_L.empty());
  EXPECT_EQ(decoded->scan.end(), kStamp);
}

TEST(PointCloudDecoding, IsDoneAtOnceWithBillionsOfEmptyRows) {
  auto message = serialised({.columns = points_on_a_line(1)});
  const std::size_t behind_header = 4 + 8 + 4 + std::string_view("lidar").size();
  for (std::size_t i = 0; i < 4; ++i) {
    message[behind_header + i] = std::byte{0xff};      // height
    message[behind_header + 4 + i] = std::byte{0x00};  // width
  }
  const auto decoded = decode_point_cloud2(message);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_TRUE(decoded->scan.points_L.empty());
}

TEST(PointCloudDecoding, RefusesEveryMessageThatIsCutShort) {
  const auto message = serialised(sweep("t", [](std::int64_t ns) { return static_cast<std::uint32_t>(ns); }));
  for (std::size_t size = 0; size < message.size(); size += size < 200 ? 1 : 97) {
    EXPECT_FALSE(decode_point_cloud2(Bytes(message).first(size))) << size;
  }
}

TEST(PointCloudDecoding, SurvivesAnyDamageToTheLayout) {
  const auto message = serialised(sweep("t", [](std::int64_t ns) { return static_cast<std::uint32_t>(ns); }));
  for (std::size_t place = 0; place < 150; ++place) {
    for (const auto value : {0x00, 0x7f, 0x80, 0xff}) {
      auto damaged = message;
      damaged[place] = static_cast<std::byte>(value);
      const auto decoded = decode_point_cloud2(damaged);
      if (!decoded) {
        EXPECT_EQ(decoded.error().kind, Error::Kind::input);
        continue;
      }
      const LidarScan& scan = decoded->scan;
      EXPECT_LE(scan.points_L.size(), kCount);
      EXPECT_EQ(scan.points_L.size(), scan.offsets.size());
      EXPECT_EQ(scan.points_L.size(), scan.intensity.size());
      EXPECT_TRUE(std::ranges::is_sorted(scan.offsets));
    }
  }
}

}  // namespace
}  // namespace pllit
