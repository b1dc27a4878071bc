#include "pllit/map/line_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "pllit/thermal/depth.hpp"
#include "support/image_world.hpp"
#include "support/random_states.hpp"

namespace pllit {
namespace {

using Eigen::Vector2d;
using test::Random;

/// One image's points of the edge from a to b.
LineSighting sighting_of(const Vector3d& a_W, const Vector3d& b_W, const SE3& T_W_C, Random& random) {
  LineSighting sighting{.T_W_C = T_W_C, .points = {}};
  for (int i = 0; i < 10; ++i) {
    const Vector3d p_W = a_W + random.uniform(0.0, 1.0) * (b_W - a_W) + random.vector(0.01);
    sighting.points.push_back({.p_C = T_W_C.inverse().act(p_W), .sigma_ray_m = 0.02, .sigma_across_m = 0.01});
  }
  return sighting;
}

/// A camera that looks along x of W from (x, 0, 0).
SE3 camera_at(double x) { return pose_from(SO3::Identity(), Vector3d(x, 0.0, 0.0)) * test::camera_ahead(); }

const Vector3d post_a(6.0, 1.0, -0.6), post_b(6.0, 1.0, 0.6);

TEST(LineMap, TakesALineThatWasSeenOftenEnough) {
  Random random(81);
  LineMap map({.min_sightings = 5});
  std::optional<TrackId> track;
  for (int image = 0; image < 5; ++image) {
    if (track) {
      EXPECT_FALSE(map.line_of(*track)) << image;
    }
    track = map.observe(track, sighting_of(post_a, post_b, camera_at(0.1 * image), random));
    map.end_image(Vector3d(0.1 * image, 0.0, 0.0));
  }
  const auto line = map.line_of(*track);
  ASSERT_TRUE(line);
  EXPECT_LT(line->axis.distance_m(post_a), 0.02);
  EXPECT_LT(line->axis.distance_m(post_b), 0.02);
  EXPECT_EQ(map.lines().size(), 1);
  EXPECT_EQ(line->sightings, 0);  // of the line as one of the map
  map.observe(track, sighting_of(post_a, post_b, camera_at(0.6), random));
  EXPECT_EQ(map.line_of(*track)->sightings, 1);
}

TEST(LineMap, IsSurerOfALineTheMoreItSeesOfItUntilItIsSettled) {
  Random random(82);
  LineMap map({.min_sightings = 5, .most_sightings = 10});
  std::optional<TrackId> track;
  std::vector<LineLandmark> history;
  for (int image = 0; image < 30; ++image) {
    track = map.observe(track, sighting_of(post_a, post_b, camera_at(0.1 * image), random));
    if (const auto line = map.line_of(*track)) history.push_back(*line);
  }
  ASSERT_GT(history.size(), 20);
  EXPECT_LT(history[5].covariance_m2.trace(), history[0].covariance_m2.trace());
  EXPECT_EQ(history[6].axis.moment, history.back().axis.moment);
}

TEST(LineMap, MergesTracksOfOneEdge) {
  Random random(83);
  LineMap map({});
  const Vector3d middle = 0.5 * (post_a + post_b);
  std::optional<TrackId> lower, upper, other;
  for (int image = 0; image < 10; ++image) {
    const SE3 T_W_C = camera_at(0.1 * image);
    lower = map.observe(lower, sighting_of(post_a, middle + Vector3d(0.0, 0.0, 0.1), T_W_C, random));
    upper = map.observe(upper, sighting_of(middle - Vector3d(0.0, 0.0, 0.1), post_b, T_W_C, random));
    const Vector3d aside(0.0, 0.3, 0.0);
    other = map.observe(other, sighting_of(post_a + aside, post_b + aside, T_W_C, random));
  }
  EXPECT_EQ(map.lines().size(), 2);
  ASSERT_TRUE(map.line_of(*lower) && map.line_of(*upper) && map.line_of(*other));
  EXPECT_EQ(map.line_of(*lower)->id, map.line_of(*upper)->id);
  EXPECT_NE(map.line_of(*lower)->id, map.line_of(*other)->id);
  EXPECT_GT(2.0 * map.line_of(*lower)->half_length_m, 0.9);
  EXPECT_LT(map.line_of(*lower)->axis.distance_m(post_a), 0.03);
}

TEST(LineMap, ForgetsLostTracksAndLinesThatTheRigLeftBehind) {
  Random random(84);
  LineMap map({.patience = 3, .keep_m = 20.0});
  std::optional<TrackId> track;
  for (int image = 0; image < 6; ++image)
    track = map.observe(track, sighting_of(post_a, post_b, camera_at(0.1 * image), random));
  for (int image = 0; image < 5; ++image) map.end_image(Vector3d::Zero());
  EXPECT_FALSE(map.line_of(*track));
  EXPECT_EQ(map.lines().size(), 1);
  EXPECT_NE(map.observe(track, sighting_of(post_a, post_b, camera_at(0.7), random)), *track);
  map.end_image(Vector3d(40.0, 0.0, 0.0));
  EXPECT_TRUE(map.lines().empty());
}

TEST(LineMap, ShowsTheLinesThatLieInTheImage) {
  Random random(85);
  LineMap map({});
  std::optional<TrackId> track;
  for (int image = 0; image < 6; ++image)
    track = map.observe(track, sighting_of(post_a, post_b, camera_at(0.1 * image), random));
  const Camera camera = test::thermal_camera();
  const auto visible = map.visible_from(camera_at(0.0), camera);
  ASSERT_EQ(visible.size(), 1);
  const auto a = camera.project(camera_at(0.0).inverse().act(post_a));
  const auto b = camera.project(camera_at(0.0).inverse().act(post_b));
  const double straight = (visible[0].start_px - *a).norm() + (visible[0].end_px - *b).norm();
  const double swapped = (visible[0].start_px - *b).norm() + (visible[0].end_px - *a).norm();
  EXPECT_LT(std::min(straight, swapped), 20.0);
  EXPECT_TRUE(map.visible_from(camera_at(7.0), camera).empty());  // behind
  EXPECT_TRUE(map.visible_from(camera_at(0.0) * pose_from(exp_so3({0.0, 1.5, 0.0}), Vector3d::Zero()), camera).empty());
  // Half in the image: only that half is shown.
  for (const VisibleLine& line : map.visible_from(camera_at(4.4), camera)) {
    EXPECT_TRUE(test::in_image(line.start_px, camera));
    EXPECT_TRUE(test::in_image(line.end_px, camera));
  }
}

/// LiDAR returns, in W, of a panel before a wall, both across x. Beams that hit both return something between.
std::vector<Vector3f> panel_and_wall(Random& random) {
  constexpr double panel_x = 4.0, wall_x = 6.5, edge_y = 0.5, beam_rad = 0.0025;
  std::vector<Vector3f> points;
  for (int i = 0; i < 40000; ++i) {
    const double azimuth = random.uniform(-0.5, 0.5), elevation = random.uniform(-0.4, 0.4);
    const Vector3d ray = Vector3d(1.0, std::tan(azimuth), std::tan(elevation)).normalized();
    const auto near = [&](double a) { return panel_x * std::tan(a) < edge_y; };
    double range = (near(azimuth) ? panel_x : wall_x) / ray.x();
    if (near(azimuth - beam_rad) != near(azimuth + beam_rad))
      range = (panel_x + random.uniform(0.0, 1.0) * (wall_x - panel_x)) / ray.x();
    points.push_back(((range + random.normal(0.02)) * ray).cast<float>());
  }
  return points;
}

TEST(LineMap, PutsALineAtAnOccludingEdgeWhereItIs) {
  Random random(86);
  const Camera camera = test::thermal_camera();
  LineMap map({});
  std::optional<TrackId> track;
  const Vector3d a_W(4.0, 0.5, -0.7), b_W(4.0, 0.5, 0.7);
  for (int image = 0; image < 10; ++image) {
    const SE3 T_W_C = camera_at(0.08 * image) * pose_from(exp_so3(random.vector(0.02)), random.vector(0.03));
    const auto seen_at = [&](const Vector3d& p_W) {
      return Eigen::Vector2f(
          (*camera.project(T_W_C.inverse().act(p_W)) + Vector2d(random.normal(0.7), random.normal(0.7))).cast<float>());
    };
    const DepthImage depths(panel_and_wall(random), T_W_C.inverse(), camera, {});
    const LineSegment segment{.start_px = seen_at(a_W), .end_px = seen_at(b_W)};
    track = map.observe(track, {.T_W_C = T_W_C, .points = points_along(segment, depths, camera)});
  }
  const auto line = map.line_of(*track);
  ASSERT_TRUE(line);
  EXPECT_LT(line->axis.distance_m(a_W), 0.015);
  EXPECT_LT(line->axis.distance_m(b_W), 0.015);
  EXPECT_LT(line->axis.distance_m(0.5 * (a_W + b_W)), 0.010);
}

}  // namespace
}  // namespace pllit
