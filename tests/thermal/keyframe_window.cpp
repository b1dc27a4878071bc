#include "pllit/thermal/keyframe_window.hpp"

#include <gtest/gtest.h>

namespace pllit {
namespace {

using Eigen::Vector2f;

constexpr int kWidth_px = 640;

Keyframe keyframe(std::uint32_t id, double at_m, double seconds) {
  Keyframe one;
  one.id = id;
  one.time = Time(from_seconds(seconds));
  one.T_W_C = pose_from(SO3::Identity(), {at_m, 0.0, 0.0});
  one.features.points_px.assign(200, Vector2f(100.0F, 100.0F));
  return one;
}

Features points_moved_by(float px) {
  Features features;
  features.points_px.assign(200, Vector2f(100.0F + px, 100.0F));
  return features;
}

Tracks matches(std::size_t with, int count) {
  Tracks tracks;
  for (int i = 0; i < count; ++i) tracks.points.push_back({.keyframe = with, .reference = i, .current = i});
  return tracks;
}

TEST(KeyframeWindow, WantsTheFirstImageThatHasPoints) {
  EXPECT_TRUE(wants_keyframe({}, {}, points_moved_by(0.0F), Time{}, kWidth_px, {}));
  EXPECT_FALSE(wants_keyframe({}, {}, Features{}, Time{}, kWidth_px, {}));
}

TEST(KeyframeWindow, WantsAnImageThatHasLostSightOfTheLastKeyframeOrMovedFar) {
  const std::vector<Keyframe> window{keyframe(0, 0.0, 0.0), keyframe(1, 1.0, 1.0)};
  const auto wants = [&](int count, float moved_px, double seconds) {
    return wants_keyframe(matches(1, count), window, points_moved_by(moved_px), Time(from_seconds(seconds)), kWidth_px,
                          {});
  };
  EXPECT_FALSE(wants(150, 5.0F, 1.5));
  EXPECT_TRUE(wants(40, 5.0F, 1.5));
  EXPECT_TRUE(wants(150, 60.0F, 1.5));
  EXPECT_TRUE(wants(150, 5.0F, 4.5));
  EXPECT_FALSE(wants(150, 0.5F, 60.0)) << "a rig at rest needs none";
  EXPECT_FALSE(wants(40, 5.0F, 1.05)) << "not two at once";
  EXPECT_TRUE(wants(10, 5.0F, 1.05)) << "but before the image is lost";
}

TEST(KeyframeWindow, KeepsTheBestPointsOfAnImage) {
  Features features = points_moved_by(0.0F);
  for (int i = 0; i < 200; ++i) features.scores.push_back(static_cast<float>(200 - i));
  features.descriptors = cv::Mat::zeros(200, 8, CV_32FC1);
  features.lines.resize(3);
  const Features best = strongest(features, 50);
  EXPECT_EQ(best.points_px.size(), 50U);
  EXPECT_EQ(best.scores.back(), 151.0F);
  EXPECT_EQ(best.descriptors.rows, 50);
  EXPECT_EQ(best.lines.size(), 3U);
  EXPECT_EQ(strongest(features, 1000).points_px.size(), 200U);
}

TEST(KeyframeWindow, DropsTheOneThatServesLeast) {
  std::vector<Keyframe> window;
  for (std::uint32_t i = 0; i < 5; ++i) window.push_back(keyframe(i, i, i));
  Tracks tracks;
  for (const auto& [with, count] : {std::pair(0, 30), {1, 3}, {2, 50}, {3, 0}, {4, 0}})
    for (const PointMatch& match : matches(static_cast<std::size_t>(with), count).points)
      tracks.points.push_back(match);
  EXPECT_EQ(expendable(tracks, window), 1U);
}

TEST(KeyframeWindow, DropsOneOfTwoThatStandTogetherWhereAllServe) {
  const std::vector<Keyframe> window{keyframe(0, 0.0, 0.0), keyframe(1, 3.0, 1.0), keyframe(2, 3.1, 2.0),
                                     keyframe(3, 6.0, 3.0), keyframe(4, 6.01, 4.0)};
  Tracks tracks;
  for (std::size_t i = 0; i < 5; ++i)
    for (const PointMatch& match : matches(i, 40).points) tracks.points.push_back(match);
  EXPECT_EQ(expendable(tracks, window), 1U);
}

}  // namespace
}  // namespace pllit
