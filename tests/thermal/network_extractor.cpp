#include "pllit/thermal/network_extractor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "support/temporary_folder.hpp"
#include "thermal/tiny_model.hpp"

namespace {

using namespace pllit;
using Eigen::Vector2f;
using testing::HasSubstr;

constexpr const char* kModel = PLLIT_MODELS "/pl_net.onnx";

std::unique_ptr<NetworkExtractor> shipped(int threads = 1) {
  auto extractor = NetworkExtractor::open({.model = kModel, .threads = threads});
  if (!extractor) throw std::runtime_error(extractor.error().message);
  return std::move(*extractor);
}

const std::vector<std::vector<cv::Point2f>> kQuads{{{60, 50}, {260, 70}, {250, 210}, {80, 190}},
                                                   {{330, 90}, {520, 60}, {560, 250}, {350, 280}},
                                                   {{120, 270}, {280, 300}, {260, 430}, {90, 400}},
                                                   {{380, 330}, {590, 340}, {570, 470}, {400, 450}}};

/// Warm and cold quadrangles on a slope of grey, blurred and noisy as a thermal camera's image is.
cv::Mat quads_image(int seed = 1) {
  cv::Mat image(512, 640, CV_32FC1);
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.cols; ++column)
      image.at<float>(row, column) = 90.0F + 0.05F * static_cast<float>(row) + 0.03F * static_cast<float>(column);
  double grey = 150.0;
  for (const auto& quad : kQuads) {
    std::vector<cv::Point> corners;
    for (const cv::Point2f& corner : quad) corners.emplace_back(corner);
    cv::fillConvexPoly(image, corners, grey, cv::LINE_AA);
    grey = grey > 120.0 ? 60.0 : 150.0;
  }
  cv::GaussianBlur(image, image, {}, 1.0);
  cv::Mat noise(image.size(), CV_32FC1), grey8;
  cv::RNG(static_cast<unsigned>(seed)).fill(noise, cv::RNG::NORMAL, 0.0, 1.5);
  cv::Mat(image + noise).convertTo(grey8, CV_8U);
  return grey8;
}

/// Share of the edge from a to b that lies within 2 px of some line of about its direction.
double covered(const cv::Point2f& a, const cv::Point2f& b, const std::vector<LineSegment>& lines) {
  int near = 0;
  constexpr int kPlaces = 50;
  for (int i = 0; i < kPlaces; ++i) {
    const float share = (static_cast<float>(i) + 0.5F) / kPlaces;
    const Vector2f at(std::lerp(a.x, b.x, share), std::lerp(a.y, b.y, share));
    near += std::ranges::any_of(lines, [&](const LineSegment& line) {
      const Vector2f along = (line.end_px - line.start_px).normalized(), offset = at - line.start_px;
      const float t = along.dot(offset);
      return t > -2.0F && t < line.length_px() + 2.0F &&
             std::abs(along.x() * offset.y() - along.y() * offset.x()) < 2.0F &&
             std::abs(along.dot(Vector2f(b.x - a.x, b.y - a.y).normalized())) > 0.98F;
    });
  }
  return static_cast<double>(near) / kPlaces;
}

TEST(NetworkExtractor, PutsLinesOnDrawnEdges) {
  const Features features = shipped()->extract(quads_image()).value();
  for (const auto& quad : kQuads)
    for (std::size_t i = 0; i < quad.size(); ++i)
      EXPECT_GT(covered(quad[i], quad[(i + 1) % quad.size()], features.lines), 0.6) << quad[i];
  for (const LineSegment& line : features.lines) {
    EXPECT_GE(line.score, 0.0F);
    EXPECT_LE(line.score, 1.0F);
  }
}

TEST(NetworkExtractor, PutsPointsOnDrawnCorners) {
  const Features features = shipped()->extract(quads_image()).value();
  int found = 0;
  for (const auto& quad : kQuads)
    for (const cv::Point2f& corner : quad)
      found += std::ranges::any_of(features.points_px,
                                   [&](const Vector2f& p) { return (p - Vector2f(corner.x, corner.y)).norm() < 3.0F; });
  EXPECT_GE(found, 14) << "of 16";
}

TEST(NetworkExtractor, MatchesPointsAcrossAMoveAndAChangeOfGain) {
  const auto extractor = shipped();
  const cv::Mat first = quads_image(1);
  const cv::Matx23f move(0.985F, -0.17F, 60.0F, 0.17F, 0.985F, -40.0F);
  cv::Mat second;
  cv::warpAffine(quads_image(2), second, move, first.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  second.convertTo(second, CV_8U, 0.5, 70.0);
  const Features a = extractor->extract(first).value(), b = extractor->extract(second).value();
  ASSERT_GT(a.points_px.size(), 10U);
  const cv::Mat likeness = a.descriptors * b.descriptors.t();
  int right = 0, possible = 0;
  for (std::size_t i = 0; i < a.points_px.size(); ++i) {
    const cv::Vec2f there = move * cv::Vec3f(a.points_px[i].x(), a.points_px[i].y(), 1.0F);
    const Vector2f expected(there[0], there[1]);
    if (std::ranges::none_of(b.points_px, [&](const Vector2f& p) { return (p - expected).norm() < 3.0F; })) continue;
    ++possible;
    cv::Point best;
    cv::minMaxLoc(likeness.row(static_cast<int>(i)), nullptr, nullptr, nullptr, &best);
    right += (b.points_px[static_cast<std::size_t>(best.x)] - expected).norm() < 3.0F;
  }
  EXPECT_GT(possible, 10);
  EXPECT_GT(right, possible / 2) << "of " << possible;
}

TEST(NetworkExtractor, TakesImagesOfAnySize) {
  const auto extractor = shipped();
  const cv::Mat whole = quads_image();
  for (const cv::Size size : {cv::Size(16, 16), cv::Size(17, 31), cv::Size(321, 257), cv::Size(639, 511)}) {
    const Features features = extractor->extract(whole(cv::Rect({0, 0}, size)).clone()).value();
    EXPECT_EQ(features.descriptors.rows, static_cast<int>(features.points_px.size()));
    for (const Vector2f& p : features.points_px) {
      EXPECT_LT(p.x(), static_cast<float>(size.width));
      EXPECT_LT(p.y(), static_cast<float>(size.height));
    }
    for (const LineSegment& line : features.lines)
      for (const Vector2f& p : {line.start_px, line.end_px}) {
        EXPECT_TRUE(p.x() >= 0 && p.x() <= static_cast<float>(size.width - 1)) << p.transpose();
        EXPECT_TRUE(p.y() >= 0 && p.y() <= static_cast<float>(size.height - 1)) << p.transpose();
      }
  }
}

TEST(NetworkExtractor, FindsNothingInBlankAndSaturatedImages) {
  const auto extractor = shipped();
  for (const int grey : {0, 128, 255}) {
    const Features features = extractor->extract(cv::Mat(512, 640, CV_8UC1, cv::Scalar(grey))).value();
    EXPECT_THAT(features.points_px, testing::IsEmpty()) << grey;
    EXPECT_THAT(features.lines, testing::IsEmpty()) << grey;
  }
}

TEST(NetworkExtractor, SaysTheSameForAnyNumberOfThreads) {
  const Features one = shipped(1)->extract(quads_image()).value(), two = shipped(2)->extract(quads_image()).value();
  ASSERT_EQ(one.points_px.size(), two.points_px.size());
  for (std::size_t i = 0; i < one.points_px.size(); ++i) EXPECT_EQ(one.points_px[i], two.points_px[i]);
  ASSERT_EQ(one.lines.size(), two.lines.size());
  for (std::size_t i = 0; i < one.lines.size(); ++i) EXPECT_EQ(one.lines[i].start_px, two.lines[i].start_px);
}

TEST(NetworkExtractor, RefusesImagesThatAreNotGreyOrTooSmall) {
  const auto extractor = shipped();
  for (const cv::Mat& image :
       {cv::Mat(64, 64, CV_8UC3), cv::Mat(64, 64, CV_16UC1), cv::Mat(15, 64, CV_8UC1), cv::Mat()}) {
    const auto features = extractor->extract(image);
    ASSERT_FALSE(features);
    EXPECT_EQ(features.error().kind, Error::Kind::input);
    EXPECT_THAT(features.error().message, HasSubstr("8-bit image of one channel"));
  }
}

TEST(NetworkExtractor, ListsTheProvidersThatThereAre) {
  EXPECT_THAT(installed_providers(), testing::Contains("cpu"));
  const auto unknown = NetworkExtractor::open({.model = kModel, .provider = "abacus"});
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, AllOf(HasSubstr("'abacus' is unknown"), HasSubstr("has: cpu")));
  if (std::ranges::contains(installed_providers(), "cuda")) return;
  const auto absent = NetworkExtractor::open({.model = kModel, .provider = "cuda"});
  ASSERT_FALSE(absent);
  EXPECT_THAT(absent.error().message, AllOf(HasSubstr("'cuda' is not installed"), HasSubstr("has: cpu")));
}

class BadModels : public testing::Test {
 protected:
  std::string message_about(std::string_view bytes) {
    const std::filesystem::path path = folder_.path() / "model.onnx";
    std::ofstream(path, std::ios::binary) << bytes;
    const auto extractor = NetworkExtractor::open({.model = path});
    EXPECT_FALSE(extractor);
    EXPECT_EQ(extractor.error().kind, Error::Kind::input);
    EXPECT_THAT(extractor.error().message, HasSubstr(path.string()));
    return extractor.error().message;
  }
  test::TemporaryFolder folder_;
};

TEST_F(BadModels, ThatAreMissingEmptyOrCutOffAreNamed) {
  const auto missing = NetworkExtractor::open({.model = folder_.path() / "none.onnx"});
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, AllOf(HasSubstr("none.onnx"), HasSubstr("no such file")));
  EXPECT_THAT(message_about(""), HasSubstr("cannot load"));
  EXPECT_THAT(message_about("certainly not a model"), HasSubstr("cannot load"));
  std::ifstream stream(kModel, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_THAT(message_about(std::string_view(whole).substr(0, whole.size() / 2)), HasSubstr("cannot load"));
}

TEST_F(BadModels, OfAnotherNetworkAreRefusedWithTheDifference) {
  EXPECT_THAT(message_about(test::tiny_model("image", "scores", {1, 1, 64, 64})), HasSubstr("1 inputs and 1 outputs"));
}

TEST(BrighterSide, LiesToTheLeftOfTheWayAlongALine) {
  cv::Mat grey(64, 64, CV_8UC1, cv::Scalar(50));
  grey.rowRange(0, 32) = 200;
  std::vector<LineSegment> lines{{.start_px = {50, 31.5F}, .end_px = {10, 31.5F}},
                                 {.start_px = {10, 31.5F}, .end_px = {50, 31.5F}}};
  turn_brighter_side_left(grey, lines);
  for (const LineSegment& line : lines) EXPECT_LT(line.start_px.x(), line.end_px.x());
}

}  // namespace
