#include "pllit/thermal/decode_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "thermal/line_map_of.hpp"

namespace {

using namespace pllit;
using Eigen::Vector2f;
using pllit::test::line_map_of;
using pllit::test::LineMap;
using pllit::test::Segment;

const cv::Size kImage(320, 256);

/// Largest distance between the ends of a decoded and a true segment, in the better of the two orders.
float distance_px(const LineSegment& line, const Segment& truth) {
  const auto apart = [&](const Vector2f& a, const Vector2f& b) {
    return std::max((line.start_px - a).norm(), (line.end_px - b).norm());
  };
  return std::min(apart(truth.a, truth.b), apart(truth.b, truth.a));
}

void expect_exactly(const std::vector<LineSegment>& lines, std::span<const Segment> truth, float least_px) {
  EXPECT_EQ(lines.size(), truth.size());
  for (const Segment& segment : truth)
    EXPECT_TRUE(
        std::ranges::any_of(lines, [&](const LineSegment& line) { return distance_px(line, segment) < least_px; }))
        << "from " << segment.a.transpose() << " to " << segment.b.transpose();
}

TEST(DecodeLines, FindsSegmentsOfAnyDirectionToAFractionOfAPixel) {
  const std::vector<Segment> truth{
      {{20, 30}, {200, 30}}, {{300, 40}, {300, 220}}, {{30, 240}, {180, 60}}, {{210, 70}, {280, 230}}};
  expect_exactly(decode_lines(line_map_of(truth, 320, 256).view(), kImage, {}), truth, 0.7F);
}

TEST(DecodeLines, KeepsRandomSegmentsThatLieApart) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> shift(-8.0F, 8.0F);
  for (int round = 0; round < 20; ++round) {
    std::vector<Segment> truth;
    for (int i = 0; i < 4; ++i) {
      const auto at = static_cast<float>(40 + 56 * i);
      truth.push_back({{30 + shift(random), at + shift(random)}, {280 + shift(random), at + shift(random)}});
    }
    expect_exactly(decode_lines(line_map_of(truth, 320, 256).view(), kImage, {}), truth, 1.0F);
  }
}

TEST(DecodeLines, SeparatesParallelEdgesSixPixelsApart) {
  const std::vector<Segment> truth{{{40, 100}, {260, 110}}, {{40, 106}, {260, 116}}};
  expect_exactly(decode_lines(line_map_of(truth, 320, 256).view(), kImage, {}), truth, 1.5F);
}

TEST(DecodeLines, EndsLinesAtJunctionsWhereTheCellsNearThemAreLost) {
  const std::vector<Segment> truth{{{40, 100}, {260, 100}}};
  LineMap map = line_map_of(truth, 320, 256);
  for (int row = 0; row < 64; ++row)
    for (int column = 64; column < 80; ++column) map.at(line_map::attraction, row, column) = 0.0F;
  expect_exactly(decode_lines(map.view(), kImage, {}), truth, 1.0F);
}

TEST(DecodeLines, BridgesAGapThatTheFieldAgreesWithAndNoOther) {
  const std::vector<Segment> truth{{{40, 100}, {260, 100}}};
  LineMap narrow = line_map_of(truth, 320, 256), wide = narrow;
  for (int row = 0; row < 64; ++row) {
    narrow.at(line_map::attraction, row, 36) = 0.2F;
    for (int column = 30; column < 50; ++column) wide.at(line_map::attraction, row, column) = 0.0F;
  }
  EXPECT_EQ(decode_lines(narrow.view(), kImage, {}).size(), 1U);
  EXPECT_EQ(decode_lines(wide.view(), kImage, {}).size(), 2U);
}

TEST(DecodeLines, FindsNothingInAFieldThatContradictsItself) {
  LineMap map = line_map_of(std::vector<Segment>{}, 320, 256);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(-1.0F, 1.0F);
  for (int row = 0; row < 64; ++row)
    for (int column = 0; column < 80; ++column) {
      map.at(line_map::attraction, row, column) = 0.9F;
      map.at(line_map::distance, row, column) = 5.0F + 5.0F * any(random);
      map.at(line_map::direction_x, row, column) = any(random);
      map.at(line_map::direction_y, row, column) = any(random);
      map.at(line_map::end_ahead, row, column) = map.at(line_map::end_behind, row, column) = 1.5F;
    }
  EXPECT_THAT(decode_lines(map.view(), kImage, {}), testing::IsEmpty());
}

TEST(DecodeLines, StaysInsideTheImageThatThePaddingExtends) {
  const std::vector<Segment> truth{{{20, 100}, {310, 100}}, {{20, 240}, {200, 240}}};
  const cv::Size smaller(301, 201);
  const std::vector<LineSegment> lines = decode_lines(line_map_of(truth, 320, 256).view(), smaller, {});
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_LT(distance_px(lines.front(), {{20, 100}, {300, 100}}), 1.0F);
}

TEST(DecodeLines, ReturnsTheBestWhenThereAreMoreThanAskedFor) {
  const std::vector<Segment> truth{{{20, 30}, {60, 30}}, {{20, 80}, {290, 80}}, {{20, 130}, {150, 130}}};
  LineDecoding config;
  config.most = 2;
  const std::vector<LineSegment> lines = decode_lines(line_map_of(truth, 320, 256).view(), kImage, config);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_LT(distance_px(lines[0], truth[1]), 1.0F);
  EXPECT_LT(distance_px(lines[1], truth[2]), 1.0F);
}

TEST(DecodeJunctions, PlacesThemByTheirOffsetsAndDropsWeakerNeighbours) {
  LineMap map = line_map_of(std::vector<Segment>{{{50.25F, 60.75F}, {200, 60}}}, 320, 256);
  map.at(line_map::junction, 15, 13) = 0.6F;  // beside the one at column 12
  const std::vector<Junction> junctions = decode_junctions(map.view(), kImage, 0.3);
  ASSERT_EQ(junctions.size(), 2U);
  EXPECT_LT((junctions[0].at_px - Vector2f(50.25F, 60.75F)).norm(), 1e-3F);
  EXPECT_LT((junctions[1].at_px - Vector2f(200, 60)).norm(), 1e-3F);
}

}  // namespace
