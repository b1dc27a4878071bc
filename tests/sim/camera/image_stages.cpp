#include "pllit/sim/camera/image_stages.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "pllit/sim/camera/fixed_pattern.hpp"

namespace pllit {
namespace {

bool same_bytes(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

TEST(ImageStages, ABlurredPointHasTheWidthAskedForAndKeepsItsSum) {
  Arena arena(2);
  cv::Mat point = cv::Mat::zeros(41, 61, CV_32FC1);
  point.at<float>(20, 30) = 1.0F;
  for (const double sigma_px : {0.6, 1.0, 2.0}) {
    const cv::Mat spread = blurred(point, sigma_px, arena);
    double sum = 0.0, across = 0.0, down = 0.0;
    for (int row = 0; row < spread.rows; ++row)
      for (int column = 0; column < spread.cols; ++column) {
        const double value = spread.at<float>(row, column);
        sum += value;
        across += value * (column - 30) * (column - 30);
        down += value * (row - 20) * (row - 20);
      }
    EXPECT_NEAR(sum, 1.0, 1e-5);
    EXPECT_NEAR(std::sqrt(across), sigma_px, 0.03 * sigma_px);
    EXPECT_NEAR(std::sqrt(down), sigma_px, 0.03 * sigma_px);
  }
}

TEST(ImageStages, BlurLeavesAnEvenImageAsItIs) {
  Arena arena(1);
  const cv::Mat even(30, 40, CV_32FC1, cv::Scalar(17.0));
  EXPECT_LT(cv::norm(blurred(even, 0.8, arena), even, cv::NORM_INF), 1e-4);
}

TEST(ImageStages, NoiseIsWhiteWithTheSigmaAskedForAndTheSameForAnyThreads) {
  Arena one(1), two(2);
  cv::Mat image = cv::Mat::zeros(400, 500, CV_32FC1), again = image.clone();
  add_noise(image, 3.0F, 11, one);
  add_noise(again, 3.0F, 11, two);
  EXPECT_TRUE(same_bytes(image, again));
  cv::Scalar mean, sigma;
  cv::meanStdDev(image, mean, sigma);
  EXPECT_NEAR(mean[0], 0.0, 0.03);
  EXPECT_NEAR(sigma[0], 3.0, 0.03);
  const cv::Mat left = image.colRange(0, 499), right = image.colRange(1, 500), top = image.rowRange(0, 399),
                bottom = image.rowRange(1, 400);
  EXPECT_LT(std::abs(left.dot(right)) / left.dot(left), 0.01);
  EXPECT_LT(std::abs(top.dot(bottom)) / top.dot(top), 0.01);
}

TEST(FixedPattern, GrowsWithTheRootOfTimeAndIsResetByTheShutter) {
  Arena arena(2);
  const FixedPatternModel model{.column_walk = 0.01,
                                .pixel_walk = 0.02,
                                .whole_walk = 0.0,
                                .column_left = 0.001,
                                .pixel_left = 0.002,
                                .whole_left = 0.0};
  FixedPattern pattern(200, 150, model, 5);
  const auto sigma = [&] {
    cv::Mat image = cv::Mat::zeros(150, 200, CV_32FC1);
    pattern.add_to(image, 1.0F, arena);
    cv::Scalar mean, deviation;
    cv::meanStdDev(image, mean, deviation);
    return deviation[0];
  };
  for (int frame = 0; frame < 400; ++frame) pattern.walk(0.1, arena);
  EXPECT_NEAR(sigma(), std::sqrt(40.0) * std::hypot(0.01, 0.02), 0.01);
  pattern.reset(arena);
  EXPECT_NEAR(sigma(), std::hypot(0.001, 0.002), 3e-4);
}

TEST(Shutter, ClosesWithinItsIntervalsForAsLongAsItSays) {
  const ShutterModel model{
      .least_interval_s = 60.0, .most_interval_s = 180.0, .least_freeze_s = 0.3, .most_freeze_s = 0.5};
  Shutter shutter(model, Time{}, 9);
  std::vector<double> closed_at_s, open_at_s{0.0};
  bool closed = false;
  for (int frame = 0; frame < 200'000; ++frame) {
    const double now_s = 0.01 * frame;
    const bool now = shutter.at(Time(from_seconds(now_s))).closed;
    if (now && !closed) closed_at_s.push_back(now_s);
    if (!now && closed) open_at_s.push_back(now_s);
    closed = now;
  }
  ASSERT_GT(closed_at_s.size(), 10U);
  for (std::size_t i = 0; i + 1 < open_at_s.size(); ++i) {
    EXPECT_GE(closed_at_s[i] - open_at_s[i], 59.98);
    EXPECT_LE(closed_at_s[i] - open_at_s[i], 180.02);
    EXPECT_GE(open_at_s[i + 1] - closed_at_s[i], 0.28);
    EXPECT_LE(open_at_s[i + 1] - closed_at_s[i], 0.52);
  }
  EXPECT_NE(closed_at_s[1] - open_at_s[1], closed_at_s[2] - open_at_s[2]);
}

}  // namespace
}  // namespace pllit
