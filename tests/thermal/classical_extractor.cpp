#include "pllit/thermal/classical_extractor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "pllit/thermal/patch_descriptor.hpp"
#include "thermal/pictures.hpp"

namespace pllit {
namespace {

using Eigen::Vector2f;
using test::picture;

cv::Mat through_curve(const cv::Mat& image, double exponent) {
  cv::Mat table(1, 256, CV_8UC1), out;
  for (int grey = 0; grey < 256; ++grey)
    table.at<std::uint8_t>(grey) = cv::saturate_cast<std::uint8_t>(20.0 + 215.0 * std::pow(grey / 255.0, exponent));
  cv::LUT(image, table, out);
  return out;
}

/// Share of a's points with one of b's within 2 px.
double repeated_share(const Features& a, const Features& b) {
  int repeated = 0;
  for (const Vector2f& p : a.points_px)
    repeated += std::ranges::any_of(b.points_px, [&](const Vector2f& q) { return (p - q).norm() < 2.0F; });
  return repeated / static_cast<double>(a.points_px.size());
}

float least_distance(const std::vector<Corner>& corners) {
  float least = 1e9F;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) least = std::min(least, (corners[i].at_px - corners[k].at_px).norm());
  return least;
}

TEST(Corners, AreToldFromNoiseByTheImagesOwnNoise) {
  for (const double noise : {0.7, 1.5, 4.0}) {
    const cv::Mat image = test::seen(test::scene({}, 8), noise, 9);
    EXPECT_NEAR(noise_grey(image), noise, 0.35 * noise + 0.2);
    const CornerConfig config;
    const cv::Mat noise_alone = test::seen(cv::Mat(256, 320, CV_32FC1, cv::Scalar(120)), noise, 10);
    EXPECT_LT(corners_of(noise_alone, config).size(), 5U) << noise;
  }
}

TEST(Corners, LieAtTheCornersOfASquare) {
  cv::Mat image(120, 160, CV_32FC1, cv::Scalar(90));
  cv::rectangle(image, {50, 40, 60, 40}, cv::Scalar(180), cv::FILLED);  // edges at 49.5, 109.5, 39.5, 79.5
  cv::GaussianBlur(image, image, {}, 0.8);
  // Blur and the window of gradients pull the maximum inside the corner, alike in all images of it.
  for (const auto& [blur_px, within_px] : {std::pair(1.0, 2.5F), std::pair(CornerConfig{}.blur_px, 3.5F)}) {
    const auto corners = corners_of(test::seen(image, 0.0, 1), {.blur_px = blur_px});
    ASSERT_GE(corners.size(), 4U);
    for (const Vector2f& truth :
         {Vector2f(49.5, 39.5), Vector2f(109.5, 39.5), Vector2f(49.5, 79.5), Vector2f(109.5, 79.5)}) {
      float nearest = 1e9F;
      for (const Corner& corner : corners) nearest = std::min(nearest, (corner.at_px - truth).norm());
      EXPECT_LT(nearest, within_px) << "blur " << blur_px;
    }
  }
}

TEST(Corners, ComeBackInSoftNoisyImages) {
  cv::Mat soft = test::scene({.blocks = 60}, 21);
  cv::GaussianBlur(soft, soft, {}, 2.0);  // as wide as edges are in thermal images
  ClassicalExtractor extractor({.most_points = 200});
  const auto first = extractor.extract(test::seen(soft, 2.0, 1)), second = extractor.extract(test::seen(soft, 2.0, 2));
  ASSERT_TRUE(first && second);
  EXPECT_GT(first->points_px.size(), 80U);
  EXPECT_GT(repeated_share(*first, *second), 0.9);
}

TEST(Corners, AreSpreadAsFarApartAsTheirNumberAllows) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<float> x(0.0F, 639.0F), y(0.0F, 511.0F), strength(0.0F, 1.0F);
  std::vector<Corner> corners(4000);
  for (Corner& corner : corners) corner = {{x(engine), y(engine)}, strength(engine)};
  std::ranges::sort(corners, std::ranges::greater{}, &Corner::strength);
  for (const int most : {50, 400, 1000}) {
    const auto kept = spread_evenly(corners, most, 40.0F);
    EXPECT_EQ(static_cast<int>(kept.size()), most);
    // A square grid of as many points over the image has this spacing; random candidates get to over half of it.
    EXPECT_GT(least_distance(kept), std::min(40.0F, 0.5F * std::sqrt(640.0F * 512.0F / static_cast<float>(most))));
    EXPECT_EQ(kept.front().strength, corners.front().strength);
  }
  EXPECT_LT(spread_evenly(corners, 5000, 40.0F).size(), corners.size() + 1);
}

TEST(Corners, AreSoughtInTheWholeImageAndNotWhereItIsBrightest) {
  // The left half has a tenth of the right one's contrast.
  cv::Mat greys = test::scene({.blocks = 60}, 5);
  greys.colRange(0, 160) = 0.1 * greys.colRange(0, 160) + 100.0;
  ClassicalExtractor extractor({.most_points = 200});
  const auto features = extractor.extract(test::seen(greys, 0.5, 6));
  ASSERT_TRUE(features.has_value());
  const auto left = std::ranges::count_if(features->points_px, [](const Vector2f& p) { return p.x() < 155.0F; });
  EXPECT_GT(left, 25);
}

TEST(Descriptors, HaveUnitLength) {
  ClassicalExtractor extractor;
  const auto features = extractor.extract(picture({}, 1));
  ASSERT_TRUE(features.has_value());
  ASSERT_EQ(features->descriptors.type(), CV_32FC1);
  ASSERT_EQ(features->descriptors.rows, static_cast<int>(features->points_px.size()));
  ASSERT_EQ(features->scores.size(), features->points_px.size());
  EXPECT_GT(features->points_px.size(), 60U);
  for (int i = 0; i < features->descriptors.rows; ++i) EXPECT_NEAR(cv::norm(features->descriptors.row(i)), 1.0, 1e-5);
}

TEST(Descriptors, SurviveIncreasingCurvesAndTellPointsApart) {
  const cv::Mat greys = test::scene({}, 11), before = test::seen(greys, 1.0, 1);
  ClassicalExtractor extractor;
  const auto points = extractor.extract(before)->points_px;
  const cv::Mat a = describe_patches(before, points);
  for (const double exponent : {0.5, 0.8, 1.6}) {
    const cv::Mat b = describe_patches(through_curve(test::seen(greys, 1.0, 2), exponent), points);
    const cv::Mat similarity = a * b.t();
    int right = 0;
    for (int i = 0; i < similarity.rows; ++i) {
      double best = 0.0;
      cv::Point place;
      cv::minMaxLoc(similarity.row(i), nullptr, &best, nullptr, &place);
      right += place.x == i;
    }
    EXPECT_GT(right / static_cast<double>(points.size()), 0.95) << exponent;
  }
}

TEST(Descriptors, OfAnEvenImageAreUnitVectorsToo) {
  const std::vector<Vector2f> points{{0.0F, 0.0F}, {31.0F, 31.0F}};
  const cv::Mat rows = describe_patches(cv::Mat(33, 47, CV_8UC1, cv::Scalar(77)), points);
  EXPECT_NEAR(cv::norm(rows.row(0)), 1.0, 1e-5);
  EXPECT_NEAR(cv::norm(rows.row(1)), 1.0, 1e-5);
}

TEST(ClassicalExtractor, FindsTheSamePointsAfterGainControl) {
  const cv::Mat greys = test::scene({}, 21);
  ClassicalExtractor extractor({.most_points = 150});
  const auto before = extractor.extract(test::seen(greys, 1.0, 1)),
             after = extractor.extract(through_curve(test::seen(greys, 1.0, 2), 0.7));
  EXPECT_GT(repeated_share(*before, *after), 0.8);
}

TEST(ClassicalExtractor, TakesOddSizesAndSaysWhatItCannotTake) {
  ClassicalExtractor extractor;
  EXPECT_TRUE(extractor.extract(picture({.width = 321, .height = 203}, 4)).has_value());
  EXPECT_TRUE(extractor.extract(cv::Mat::zeros(17, 16, CV_8UC1)).has_value());
  const auto small = extractor.extract(cv::Mat::zeros(8, 640, CV_8UC1));
  ASSERT_FALSE(small.has_value());
  EXPECT_NE(small.error().message.find("640 x 8"), std::string::npos) << small.error().message;
  EXPECT_FALSE(extractor.extract(cv::Mat::zeros(64, 64, CV_16UC1)).has_value());
}

TEST(ClassicalExtractor, FindsNothingInABlankImage) {
  ClassicalExtractor extractor;
  const auto features = extractor.extract(cv::Mat(240, 320, CV_8UC1, cv::Scalar(128)));
  ASSERT_TRUE(features.has_value());
  EXPECT_TRUE(features->points_px.empty());
  EXPECT_TRUE(features->lines.empty());
}

TEST(Lines, FollowTheEdgesOfASquareWithTheBrightSideOnOneHand) {
  cv::Mat image(240, 320, CV_32FC1, cv::Scalar(90));
  cv::rectangle(image, {80, 60, 160, 120}, cv::Scalar(170), cv::FILLED);
  cv::GaussianBlur(image, image, {}, 1.0);
  const auto lines = line_segments(test::seen(image, 0.7, 1), {});
  ASSERT_EQ(lines.size(), 4U);
  const Vector2f centre(159.5F, 119.5F);
  int left = 0;
  for (const LineSegment& line : lines) {
    const Vector2f along = line.end_px - line.start_px, to_centre = centre - line.start_px;
    left += along.x() * to_centre.y() - along.y() * to_centre.x() > 0.0F;
    EXPECT_GT(line.length_px(), 100.0F);
  }
  EXPECT_TRUE(left == 0 || left == 4) << left;
}

TEST(Lines, OfOneEdgeAreMergedAndParallelOnesAreNot) {
  const std::vector<LineSegment> pieces{{.start_px = {10.0F, 10.0F}, .end_px = {60.0F, 10.3F}},
                                        {.start_px = {66.0F, 10.2F}, .end_px = {110.0F, 10.0F}},
                                        {.start_px = {10.0F, 16.0F}, .end_px = {110.0F, 16.0F}},
                                        {.start_px = {60.0F, 10.0F}, .end_px = {10.0F, 10.0F}},     // bright side below
                                        {.start_px = {200.0F, 10.0F}, .end_px = {240.0F, 10.0F}}};  // too far
  const auto lines = merged(pieces, {});
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_NEAR(lines[0].length_px(), 100.0F, 0.5F);
  EXPECT_NEAR(lines[1].length_px(), 100.0F, 0.5F);
}

}  // namespace
}  // namespace pllit
