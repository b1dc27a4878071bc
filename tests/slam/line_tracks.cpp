#include "pllit/slam/line_tracks.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/image_world.hpp"
#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

/// From (x, 0, 0), along x.
SE3 camera_at(double x) { return pose_from(SE3::Identity().asSO3(), Vector3d(x, 0.0, 0.0)) * test::camera_ahead(); }

/// LiDAR points of a wall across x, in W.
std::vector<Vector3f> wall(Random& random) {
  std::vector<Vector3f> points;
  for (int i = 0; i < 20000; ++i)
    points.push_back(
        Vector3d(5.0 + random.normal(0.02), random.uniform(-3.0, 3.0), random.uniform(-2.0, 2.0)).cast<float>());
  return points;
}

const Vector3d post_a(5.0, 0.6, -0.7), post_b(5.0, 0.6, 0.7);
const Vector3d other_a(5.0, -1.0, -0.7), other_b(5.0, -1.0, 0.7);

/// The two posts on the wall, in this order or the other one.
Features features_at(double x, bool swapped) {
  const Camera camera = test::thermal_camera();
  const auto seen = [&](const Vector3d& a_W, const Vector3d& b_W) {
    const SE3 T_C_W = camera_at(x).inverse();
    return LineSegment{.start_px = camera.project(T_C_W.act(a_W))->cast<float>(),
                       .end_px = camera.project(T_C_W.act(b_W))->cast<float>()};
  };
  Features features;
  features.lines = {seen(post_a, post_b), seen(other_a, other_b)};
  if (swapped) std::swap(features.lines[0], features.lines[1]);
  return features;
}

TEST(LineTracks, FollowALineFromKeyframeToKeyframeUntilItIsOneOfTheMap) {
  Random random(91);
  Arena arena(2);
  LineTracks lines({.min_sightings = 4});
  std::vector<bool> swapped;  // of the keyframes
  std::vector<Keyframe> keyframes;
  for (int image = 0; image < 8; ++image) {
    const double x = 0.1 * image;
    const bool swap = image % 3 == 1;
    Tracks tracks;
    for (std::size_t k = 0; k < swapped.size(); ++k)
      for (int line = 0; line < 2; ++line)
        tracks.lines.push_back({.keyframe = k, .reference = swapped[k] == swap ? line : 1 - line, .current = line});
    const Features now = features_at(x, swap);
    const auto observed = lines.observed(now, tracks, keyframes);
    EXPECT_EQ(observed.size(), image < 4 ? 0 : 2) << image;
    for (const LineObservation& line : observed) {
      const bool right_one = line.start_px == now.lines[swap ? 1 : 0].start_px.cast<double>();
      EXPECT_EQ(line.keyframe, 0);  // every keyframe saw both
      EXPECT_LT((keyframes[0].T_W_C * line.line_K.axis).distance_m(right_one ? post_a : other_a), 0.02);
    }
    const DepthImage depths(wall(random), camera_at(x).inverse(), test::thermal_camera(), {});
    lines.add(now, tracks, depths, camera_at(x), test::thermal_camera(), arena);
    if (image % 2 == 0) {
      lines.keep();
      swapped.push_back(swap);
      keyframes.push_back({.T_W_C = camera_at(x)});
      if (swapped.size() > 2) {
        lines.drop(0);
        swapped.erase(swapped.begin());
        keyframes.erase(keyframes.begin());
      }
    }
  }
  EXPECT_EQ(lines.map().lines().size(), 2);
  lines.restart();
  EXPECT_TRUE(lines.map().lines().empty());
}

TEST(LineTracks, BeginAnewWithoutMatches) {
  Random random(92);
  Arena arena(2);
  LineTracks lines({.min_sightings = 3});
  for (int image = 0; image < 6; ++image) {
    const DepthImage depths(wall(random), camera_at(0.0).inverse(), test::thermal_camera(), {});
    lines.add(features_at(0.0, false), {}, depths, camera_at(0.0), test::thermal_camera(), arena);
  }
  EXPECT_TRUE(lines.map().lines().empty());
}

}  // namespace
}  // namespace pllit
