#include "pllit/thermal/grey_input.hpp"

#include <gtest/gtest.h>

#include "thermal/pictures.hpp"

namespace pllit {
namespace {

cv::Mat counts_of(double scale, double offset, unsigned seed) {
  cv::Mat counts;
  test::scene({}, seed).convertTo(counts, CV_16U, scale, offset);
  return counts;
}

TEST(GreyInput, AppliesTheCurveWhereGreysLieWithinRange) {
  const GreyCurve curve{.gain = 0.8, .bias = 20.0, .knots = {}, .offsets = {}};
  const cv::Mat grey = test::picture({}, 1), image = calibrated_image(grey, curve);
  for (int i = 0; i < grey.cols; ++i) {
    const double value = curve(grey.at<std::uint8_t>(100, i));
    if (value > 25.0 && value < 230.0) {
      EXPECT_NEAR(image.at<std::uint8_t>(100, i), value, 0.51);
    }
  }
}

TEST(GreyInput, KeepsTheOrderOfGreysThatTheCurveTakesBeyondTheRange) {
  const GreyCurve curve{.gain = 1.6, .bias = -40.0, .knots = {}, .offsets = {}};
  cv::Mat ramp(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
  const cv::Mat image = calibrated_image(ramp, curve);
  for (int i = 16; i < 256; i += 16) EXPECT_GT(image.at<std::uint8_t>(i), image.at<std::uint8_t>(i - 16));
}

TEST(GreyInput, TakesTheLuminanceOfColourImages) {
  cv::Mat colour;
  const cv::Mat grey = test::picture({}, 2);
  cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
  EXPECT_EQ(cv::norm(one_channel(colour), grey, cv::NORM_INF), 0.0);
  EXPECT_EQ(one_channel(counts_of(3.0, 7000.0, 1)).type(), CV_16UC1);
}

TEST(GreyInput, MapsCountsOverTheGreysThatThereAre) {
  const cv::Mat counts = counts_of(10.0, 7000.0, 3), image = mapped(counts, count_range(counts, {}, {}));
  double low = 0.0, high = 0.0;
  cv::minMaxLoc(image, &low, &high);
  EXPECT_LT(low, 40.0);
  EXPECT_GT(high, 215.0);
  EXPECT_GT(low, 0.0);
  EXPECT_LT(high, 255.0);
}

TEST(GreyInput, KeepsTheRangeWhileItHoldsTheImages) {
  const CountRange range = count_range(counts_of(10.0, 7000.0, 3), {}, {});
  const CountRange next = count_range(counts_of(9.5, 7060.0, 3), range, {});
  EXPECT_EQ(next.low, range.low);
  EXPECT_EQ(next.high, range.high);
}

TEST(GreyInput, MovesTheRangeSlowlyAfterTheSceneAndAtOnceAfterAJump) {
  const CountRange range = count_range(counts_of(10.0, 7000.0, 3), {}, {});
  const cv::Mat warmer = counts_of(10.0, 7900.0, 3);
  const CountRange wanted = count_range(warmer, {}, {}), next = count_range(warmer, range, {});
  EXPECT_NEAR(next.low - range.low, 0.05 * (wanted.low - range.low), 1e-6);
  const cv::Mat elsewhere = counts_of(10.0, 20000.0, 3);
  EXPECT_EQ(count_range(elsewhere, range, {}).low, count_range(elsewhere, {}, {}).low);
  // A scene that fills a third of the range has too few greys.
  EXPECT_LT(count_range(counts_of(3.0, 8000.0, 3), range, {}).high, range.high);
}

TEST(GreyInput, DoesNotStretchNoiseOverAllGreys) {
  const cv::Mat even(64, 64, CV_16UC1, cv::Scalar(7000));
  const CountRange range = count_range(even, {}, {});
  EXPECT_EQ(range.high - range.low, GreyInputConfig{}.least_counts);
  EXPECT_NEAR(mapped(even, range).at<std::uint8_t>(5, 5), 128, 1);
}

}  // namespace
}  // namespace pllit
