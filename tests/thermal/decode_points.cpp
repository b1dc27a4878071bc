#include "pllit/thermal/decode_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using namespace pllit;
using Eigen::Vector2f;

/// A bell of width 0.9 px with the given top.
void add_bell(cv::Mat& scores, const Vector2f& at, float top) {
  for (int row = 0; row < scores.rows; ++row)
    for (int column = 0; column < scores.cols; ++column) {
      const float squared = (Vector2f(static_cast<float>(column), static_cast<float>(row)) - at).squaredNorm();
      scores.at<float>(row, column) += top * std::exp(-squared / (2.0F * 0.9F * 0.9F));
    }
}

cv::Mat no_scores(int width = 96, int height = 64) { return cv::Mat::zeros(height, width, CV_32FC1); }

TEST(DecodePoints, FindsPeaksToAFractionOfAPixelBestFirst) {
  cv::Mat scores = no_scores();
  const std::vector<Vector2f> truth{{20.3F, 30.6F}, {60.0F, 12.25F}, {70.8F, 50.0F}};
  for (std::size_t i = 0; i < truth.size(); ++i) add_bell(scores, truth[i], 0.8F - 0.2F * static_cast<float>(i));
  const std::vector<Corner> points = decode_points(scores, scores.size(), {});
  ASSERT_EQ(points.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_LT((points[i].at_px - truth[i]).norm(), 0.15F);
  EXPECT_GT(points[0].strength, points[1].strength);
}

TEST(DecodePoints, KeepsOnlyTheBestOfPeaksCloserThanTheSuppressionReaches) {
  cv::Mat scores = no_scores();
  add_bell(scores, {40, 30}, 0.8F);
  add_bell(scores, {43, 30}, 0.5F);
  EXPECT_EQ(decode_points(scores, scores.size(), {}).size(), 1U);
  PointDecoding narrow;
  narrow.suppression_px = 2;
  EXPECT_EQ(decode_points(scores, scores.size(), narrow).size(), 2U);
}

TEST(DecodePoints, LeavesTheMarginAndThePaddingAlone) {
  cv::Mat scores = no_scores();
  add_bell(scores, {2, 30}, 0.8F);
  add_bell(scores, {90, 30}, 0.8F);
  add_bell(scores, {50, 60}, 0.8F);
  EXPECT_THAT(decode_points(scores, cv::Size(85, 57), {}), testing::IsEmpty());
}

TEST(DecodePoints, FindsNothingBelowTheThreshold) {
  cv::Mat scores = no_scores();
  scores = 0.004F;
  EXPECT_THAT(decode_points(scores, scores.size(), {}), testing::IsEmpty());
}

TEST(SampleDescriptors, InterpolatesBetweenTheCentresOfCells) {
  // Two channels over 2 x 3 cells: the first grows along x, the second is one.
  const std::vector<float> values{0, 1, 2, 0, 1, 2, 1, 1, 1, 1, 1, 1};
  const MapView map{.values = values.data(), .channels = 2, .rows = 2, .columns = 3};
  const auto ratio = [&](float x) {
    const cv::Mat row = sample_descriptors(map, {{{x, 8.0F}, 1.0F}});
    EXPECT_NEAR(row.dot(row), 1.0, 1e-5);
    return row.at<float>(0, 0) / row.at<float>(0, 1);
  };
  EXPECT_NEAR(ratio(3.5F), 0.0F, 1e-5F);
  EXPECT_NEAR(ratio(11.5F), 1.0F, 1e-5F);
  EXPECT_NEAR(ratio(13.5F), 1.25F, 1e-5F);
  EXPECT_NEAR(ratio(23.0F), 2.0F, 1e-5F) << "beyond the last centre the last cell counts";
}

}  // namespace
