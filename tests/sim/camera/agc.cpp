#include "pllit/sim/camera/agc.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

constexpr int kLevels = 4096;

/// A warm half, a cold half, and a few very hot pixels.
cv::Mat two_temperatures(std::uint64_t seed) {
  Random random(seed);
  cv::Mat counts(100, 120, CV_16UC1);
  for (int row = 0; row < counts.rows; ++row)
    for (int column = 0; column < counts.cols; ++column) {
      const double level = row < 50 ? 1000.0 : 1200.0;
      counts.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(level + 20.0 * random.gaussian());
    }
  for (int i = 0; i < 30; ++i) counts.at<std::uint16_t>(i, i) = 3500;
  return counts;
}

int count_of(const cv::Mat& counts, int value) {
  int number = 0;
  for (int row = 0; row < counts.rows; ++row)
    for (int column = 0; column < counts.cols; ++column)
      number += counts.at<std::uint16_t>(row, column) == value ? 1 : 0;
  return number;
}

TEST(Agc, PlateauGrowsByTheClippedShareOfEachCountButNoFasterThanItsLimit) {
  const cv::Mat counts = two_temperatures(3);
  const AgcConfig config{.plateau = 0.004, .max_gain = 0.9};
  const GreyMapping mapping = grey_mapping(counts, config, kLevels);
  const double limit = config.plateau * 12000.0;
  double clipped = 0.0;
  for (int value = 900; value < 3600; ++value) clipped += std::min<double>(count_of(counts, value), limit);
  bool gain_limited = false, plateau_limited = false, free = false;
  for (int value = 900; value < 3600; ++value) {
    const double number = count_of(counts, value), wanted = 255.0 * std::min(number, limit) / clipped;
    const auto index = static_cast<std::size_t>(value);
    EXPECT_NEAR(mapping[index] - mapping[index - 1], std::min(wanted, config.max_gain), 1e-3) << value;
    gain_limited |= wanted > config.max_gain;
    plateau_limited |= number > limit;
    free |= number > 0 && wanted < config.max_gain && number < limit;
  }
  EXPECT_TRUE(gain_limited && plateau_limited && free) << "each rule has been at work";
}

TEST(Agc, PlateauLeavesUnusedGreysEvenlyOnBothSides) {
  const GreyMapping mapping = grey_mapping(two_temperatures(3), {.plateau = 0.01, .max_gain = 0.2}, kLevels);
  EXPECT_GT(mapping.front(), 20.0F);
  EXPECT_NEAR(mapping.front() + mapping.back(), 255.0F, 0.01F);
}

TEST(Agc, WithoutLimitsPlateauIsHistogramEqualisation) {
  const cv::Mat counts = two_temperatures(4);
  const cv::Mat grey = applied(grey_mapping(counts, {.plateau = 1.0, .max_gain = 1e9}, kLevels), counts);
  for (const int level : {64, 128, 192}) {
    int below = 0;
    for (int row = 0; row < grey.rows; ++row)
      for (int column = 0; column < grey.cols; ++column) below += grey.at<std::uint8_t>(row, column) <= level ? 1 : 0;
    EXPECT_NEAR(below / 12000.0, level / 255.0, 0.03);
  }
}

TEST(Agc, LinearRejectsAsManyPixelsAtEitherEndAsAsked) {
  const cv::Mat counts = two_temperatures(5);
  const AgcConfig config{.kind = AgcConfig::Kind::linear, .tail = 0.02, .max_gain = 100.0};
  const cv::Mat grey = applied(grey_mapping(counts, config, kLevels), counts);
  int black = 0, white = 0;
  for (int row = 0; row < grey.rows; ++row)
    for (int column = 0; column < grey.cols; ++column) {
      black += grey.at<std::uint8_t>(row, column) == 0 ? 1 : 0;
      white += grey.at<std::uint8_t>(row, column) == 255 ? 1 : 0;
    }
  EXPECT_NEAR(black / 12000.0, 0.02, 0.006);
  EXPECT_NEAR(white / 12000.0, 0.02, 0.006);
}

TEST(Agc, LinearIsAStraightLineBetweenItsTails) {
  const GreyMapping mapping =
      grey_mapping(two_temperatures(5), {.kind = AgcConfig::Kind::linear, .tail = 0.02, .max_gain = 100.0}, kLevels);
  const float slope = mapping[1101] - mapping[1100];
  EXPECT_GT(slope, 0.5F);
  for (std::size_t count = 1000; count < 1200; ++count) EXPECT_NEAR(mapping[count + 1] - mapping[count], slope, 1e-4F);
}

TEST(Agc, TheMappingFollowsAStepAsTheTausFilterDoes) {
  const GreyMapping before(16, 40.0F), target(16, 200.0F);
  GreyMapping mapping = smoothed({}, before, 64);
  EXPECT_EQ(mapping, before) << "nothing came before the first";
  for (int frame = 1; frame <= 20; ++frame) {
    mapping = smoothed(mapping, target, 64);
    EXPECT_NEAR(mapping[7], 200.0 - 160.0 * std::pow(1.0 - 64.0 / 256.0, frame), 1e-3);
  }
  EXPECT_EQ(smoothed(before, target, 256), target) << "256 is immediate";
  EXPECT_EQ(smoothed(before, target, 0), before) << "0 is frozen";
}

}  // namespace
}  // namespace pllit
