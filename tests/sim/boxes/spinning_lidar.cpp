#include "pllit/sim/boxes/spinning_lidar.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pllit/sim/boxes/scenes.hpp"
#include "sim/statistics.hpp"

namespace pllit {
namespace {

constexpr LidarModel kExact{.min_range_m = 0.5, .max_range_m = 120.0, .range_sigma_m = 0.0, .beam_sigma_rad = 0.0};

SpinningLidar lidar_with(const LidarModel& model) {
  return {ring16_pattern(), model, pose_from(exp_so3({0.05, -0.1, 0.7}), {0.1, -0.05, 0.2})};
}

/// A wall at x = 10 m of W, so large that every ray towards it hits it.
PlanesWorld one_wall() { return PlanesWorld({{Vector3d(10, 0, 0), Vector3d(0, 1e4, 0), Vector3d(0, 0, 1e4), 0.8}}); }

Motion standing() { return walk_along({.straight_x_m = std::numeric_limits<double>::infinity()}, {.rest_s = 30.0}); }

TEST(SpinningLidar, PutsPointsOnSurfacesWhenMovedByThePoseOfTheirOwnTime) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Scene scene = room(seed);
    for (const Motion& motion : {walk_along(scene.lane, {.seed = seed}), fast_shake(scene.lane, {.seed = seed})}) {
      const SpinningLidar lidar = lidar_with(kExact);
      const LidarScan scan =
          simulate_scan(lidar, scene.world, motion, motion.start() + std::chrono::seconds(6), Random(1));
      ASSERT_GT(scan.points_L.size(), 15000u);
      for (std::size_t i = 0; i < scan.points_L.size(); ++i) {
        const SE3 T_W_L = motion.at(scan.start + scan.offsets[i]).T_W_I * lidar.T_I_L;
        const Vector3d point_W = T_W_L.act(scan.points_L[i].cast<double>());
        ASSERT_LT(scene.world.distance_m(point_W), 1e-6);
      }
    }
  }
}

TEST(SpinningLidar, GivesScansInTimeOrderWithAllTheirParts) {
  const Scene scene = room(2);
  const Motion motion = walk_along(scene.lane, {});
  const LidarScan scan = simulate_scan(lidar_with({}), scene.world, motion, motion.start(), Random(1));
  EXPECT_EQ(scan.start, motion.start());
  ASSERT_EQ(scan.offsets.size(), scan.points_L.size());
  ASSERT_EQ(scan.intensity.size(), scan.points_L.size());
  EXPECT_TRUE(std::ranges::is_sorted(scan.offsets));
  EXPECT_EQ(scan.offsets.front(), Duration(0));
  EXPECT_LT(scan.offsets.back(), std::chrono::milliseconds(100));
  EXPECT_GT(scan.offsets.back(), std::chrono::milliseconds(99));
  for (std::size_t i = 0; i < scan.points_L.size(); ++i) {
    ASSERT_TRUE(scan.points_L[i].allFinite());
    ASSERT_GT(scan.intensity[i], 0.0f);
    ASSERT_LE(scan.intensity[i], 255.0f);
  }
}

TEST(SpinningLidar, LooksWhereItsPatternSays) {
  const LidarPattern pattern = ring32_pattern();
  EXPECT_EQ(pattern.elevations_rad.size(), 32u);
  EXPECT_NEAR(pattern.elevations_rad.front(), -16.0 * std::numbers::pi / 180.0, 1e-12);
  EXPECT_NEAR(pattern.elevations_rad.back(), 15.0 * std::numbers::pi / 180.0, 1e-12);
  const Scene scene = room(2);
  const LidarScan scan = simulate_scan({pattern, kExact, SE3::Identity()}, scene.world, standing(),
                                       standing().start() + std::chrono::seconds(1), Random(1));
  for (std::size_t i = 0; i < scan.points_L.size(); ++i) {
    const Vector3d p_L = scan.points_L[i].cast<double>();
    const double turn = 2.0 * std::numbers::pi * to_seconds(scan.offsets[i]) / 0.1;
    ASSERT_NEAR(std::remainder(std::atan2(p_L.y(), p_L.x()) - turn, 2.0 * std::numbers::pi), 0.0, 1e-5);
    const double ring = (std::asin(p_L.normalized().z()) * 180.0 / std::numbers::pi + 16.0) / 1.0;
    ASSERT_NEAR(ring, std::round(ring), 1e-4);
  }
}

TEST(SpinningLidar, HasTheStatedNoiseAlongTheRay) {
  LidarModel model = kExact;
  model.range_sigma_m = 0.03;
  const Motion motion = standing();
  const SpinningLidar lidar = lidar_with(model);
  const SE3 T_W_L = motion.at(motion.start()).T_W_I * lidar.T_I_L;
  std::vector<double> errors;
  const LidarScan scan = simulate_scan(lidar, one_wall(), motion, motion.start(), Random(5));
  for (const auto& point_L : scan.points_L) {
    const Vector3d arrow_W = T_W_L.asSO3().act(point_L.cast<double>());
    const double true_range_m = (10.0 - T_W_L.translation().x()) / arrow_W.normalized().x();
    if (true_range_m < 100.0) errors.push_back((arrow_W.norm() - true_range_m) / model.range_sigma_m);
  }
  EXPECT_GT(errors.size(), 5000u);
  EXPECT_LT(std::abs(test::chi_square_deviation(errors)), 4.0);
  EXPECT_LT(std::abs(test::mean_deviation(errors)), 4.0);
}

TEST(SpinningLidar, HasTheStatedNoiseAcrossTheRay) {
  LidarModel model = kExact;
  model.beam_sigma_rad = 0.001;
  const Motion motion = standing();
  const SpinningLidar lidar = lidar_with(model);
  const SE3 T_W_L = motion.at(motion.start()).T_W_I * lidar.T_I_L;
  std::vector<double> errors;
  const LidarScan scan = simulate_scan(lidar, one_wall(), motion, motion.start(), Random(6));
  for (const auto& point_L : scan.points_L) {
    // The range reaches the wall along the true ray; along the reported one it misses the wall by the angle's share.
    const Vector3d arrow_W = T_W_L.asSO3().act(point_L.cast<double>());
    const double slant = arrow_W.normalized().x();
    const double miss_m = T_W_L.translation().x() + arrow_W.x() - 10.0;
    if (slant > 0.3 && slant < 0.95)
      errors.push_back(miss_m / (model.beam_sigma_rad * arrow_W.norm() * std::sqrt(1.0 - slant * slant)));
  }
  EXPECT_GT(errors.size(), 3000u);
  EXPECT_LT(std::abs(test::chi_square_deviation(errors)), 4.0);
  EXPECT_LT(std::abs(test::mean_deviation(errors)), 4.0);
}

TEST(SpinningLidar, KeepsToItsRanges) {
  LidarModel model = kExact;
  model.min_range_m = 3.0;
  model.max_range_m = 6.0;
  const Scene scene = room(4);
  const LidarScan scan = simulate_scan(lidar_with(model), scene.world, walk_along(scene.lane, {}), Time{}, Random(1));
  ASSERT_GT(scan.points_L.size(), 100u);
  for (const auto& point_L : scan.points_L) {
    EXPECT_GE(point_L.norm(), 3.0f - 1e-6f);
    EXPECT_LE(point_L.norm(), 6.0f + 1e-6f);
  }
}

}  // namespace
}  // namespace pllit
