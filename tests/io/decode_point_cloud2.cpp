#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "io/sweep.hpp"

namespace pllit {
namespace {

using namespace std::chrono_literals;
using namespace test;
using ::testing::HasSubstr;

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
