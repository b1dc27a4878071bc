#include "pllit/sim/motion/continuation.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "pllit/io/tum.hpp"
#include "pllit/sim/motion/arcs.hpp"
#include "pllit/sim/motion/fit.hpp"
#include "pllit/sim/motion/paths.hpp"
#include "pllit/sim/random.hpp"
#include "sim/motion/checks.hpp"
#include "support/recordings.hpp"

namespace pllit {
namespace {

using Way = ContinuationConfig::Way;

TEST(Connection, LeadsFromOnePoseToTheOtherWithoutAKink) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const PlanePose from{100.0 * Eigen::Vector2d(random.gaussian(), random.gaussian()), random.uniform(-3.0, 3.0)};
    const PlanePose to{100.0 * Eigen::Vector2d(random.gaussian(), random.gaussian()), random.uniform(-3.0, 3.0)};
    const ArcStraightArc road = connection(from, to, 20.0);
    ASSERT_LT((road.at(road.length_m()).position - to.position).norm(), 1e-8);
    ASSERT_NEAR(std::cos(road.at(road.length_m()).heading_rad - to.heading_rad), 1.0, 1e-9);
    const double step_m = road.length_m() / 1000.0;
    for (int k = 0; k < 1000; ++k) {
      const PlanePose here = road.at(k * step_m), next = road.at((k + 1) * step_m);
      ASSERT_NEAR((next.position - here.position).norm(), step_m, 1e-4 * step_m + 1e-9);
      ASSERT_LT(std::abs(next.heading_rad - here.heading_rad), step_m / 20.0 + 1e-9);
    }
  }
}

void expect_drivable(const Trajectory& path) {
  const auto fitted = motion_along(path, kCarFit);
  ASSERT_TRUE(fitted) << fitted.error().message;
  const test::Magnitudes all = test::magnitudes(fitted->motion);
  EXPECT_LT(all.percentile_99(all.acceleration_mps2), 4.0);
  for (Time t = fitted->motion.start() + std::chrono::seconds(10); t < fitted->motion.end();
       t += std::chrono::milliseconds(50)) {
    const MotionState state = fitted->motion.at(t);
    const double speed_mps = state.v_W.norm();
    if (speed_mps < 1.0) continue;
    const Vector3d ahead = state.v_W / speed_mps;
    const double curvature_pm = ahead.cross(state.a_W).norm() / (speed_mps * speed_mps);
    ASSERT_LT(curvature_pm * std::min(speed_mps, 8.0), 1.3);
    ASSERT_LT(std::abs(ahead.z()), 0.2);
    ASSERT_GT(state.T_W_I.asSO3().act(Vector3d::UnitX()).dot(ahead), 0.9) << to_seconds(t - fitted->motion.start());
  }
}

TEST(Continued, ReachesItsLengthAndCanBeDriven) {
  const Trajectory path = test::winding_path(60.0);  // 300 m
  for (const Way way : {Way::new_area, Way::revisit}) {
    const Trajectory longer = continued(path, {.length_m = 1500.0, .way = way});
    EXPECT_NEAR(path_length_m(longer), 1500.0, 1.5);
    for (std::size_t i = 0; i < path.size(); ++i) ASSERT_EQ(longer[i].T_W_I.coeffs(), path[i].T_W_I.coeffs());
    expect_drivable(longer);
  }
}

TEST(Continued, ComesBackToTheSamePlacesOnARevisit) {
  const Trajectory path = test::winding_path(60.0);
  const Trajectory longer = continued(path, {.length_m = 2000.0, .way = Way::revisit});
  for (std::size_t i = 0; i < path.size(); i += 10) {
    double nearest_m = 1e9;
    for (std::size_t k = path.size(); k < longer.size(); ++k)
      nearest_m = std::min(nearest_m, (longer[k].T_W_I.translation() - path[i].T_W_I.translation()).norm());
    EXPECT_LT(nearest_m, 0.5);
  }
}

TEST(Continued, KeepsANewAreaClearOfTheOld) {
  const Trajectory path = test::winding_path(60.0);
  const Trajectory longer = continued(path, {.length_m = 700.0, .way = Way::new_area});
  const Trajectory second(longer.end() - 400, longer.end());  // the last 200 m lie well within the second drive
  for (const StampedPose& there : second)
    for (const StampedPose& before : path)
      ASSERT_GT((there.T_W_I.translation() - before.T_W_I.translation()).norm(), 40.0);
}

TEST(Continued, DoublesARecordedDrive) {
  PLLIT_RECORDING(file, "trajectories/kitti_00.tum");
  const Trajectory drive = *read_tum(file);
  for (const Way way : {Way::new_area, Way::revisit}) {
    const Trajectory longer = continued(drive, {.length_m = 7400.0, .way = way});
    EXPECT_NEAR(path_length_m(longer), 7400.0, 2.0);
    expect_drivable(longer);
  }
}

TEST(StreetDrive, HasItsLengthAndSpeedAndNeverMeetsItself) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Trajectory path = street_drive({.seed = seed, .length_m = 1500.0, .speed_mps = 12.0});
    EXPECT_NEAR(path_length_m(path), 1500.0, 2.0);
    for (std::size_t i = 1; i < path.size(); ++i) {
      ASSERT_GT(path[i].T_W_I.translation().x(), path[i - 1].T_W_I.translation().x());
      ASSERT_LT((path[i].T_W_I.translation() - path[i - 1].T_W_I.translation()).norm(), 1.21);
    }
    expect_drivable(on_ground(path, Ground({.seed = seed}), 1.7, Stance::tilted));
  }
}

TEST(StreetDrive, IsTheSameForTheSameSeedOnly) {
  const auto end = [](std::uint64_t seed) { return street_drive({.seed = seed}).back().T_W_I.coeffs().eval(); };
  EXPECT_EQ(end(1), end(1));
  EXPECT_NE(end(1), end(2));
}

}  // namespace
}  // namespace pllit
