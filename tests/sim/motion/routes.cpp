#include "pllit/sim/motion/routes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/motion/checks.hpp"

namespace pllit {
namespace {

TEST(Routes, StartAtRestWithExactDerivatives) {
  for (const Motion& motion :
       {inspection_walk({.seed = 3}), corridor_walk({.seed = 3, .length_m = 20.0}), stair_climb({.seed = 3})}) {
    test::expect_exact_rest(motion, 2.0);
    test::expect_exact_derivatives(motion);
    const test::Magnitudes all = test::magnitudes(motion);
    EXPECT_LT(all.acceleration_mps2.back(), 6.0);
    EXPECT_LT(all.rate_rps.back(), 3.0);
  }
}

TEST(InspectionWalk, MakesItsLapsWithinTheLane) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Motion motion = inspection_walk({.seed = seed, .laps = 2.5});
    double around_rad = 0.0;
    Vector3d last = motion.at(motion.start()).T_W_I.translation();
    for (Time t = motion.start(); t < motion.end(); t += std::chrono::milliseconds(50)) {
      const Vector3d p_W = motion.at(t).T_W_I.translation();
      around_rad += std::atan2(last.x() * p_W.y() - last.y() * p_W.x(), last.head<2>().dot(p_W.head<2>()));
      last = p_W;
      ASSERT_LT(std::abs(p_W.x()), 4.0 + kLaneHalfWidth_m);
      ASSERT_LT(std::abs(p_W.y()), 3.0 + kLaneHalfWidth_m);
    }
    EXPECT_NEAR(std::abs(around_rad) / (2.0 * std::numbers::pi), 2.5, 0.35) << seed;
  }
}

TEST(CorridorWalk, GoesToTheEndAndBack) {
  const Motion motion = corridor_walk({.seed = 2, .length_m = 100.0});
  double farthest_m = 0.0;
  for (Time t = motion.start(); t < motion.end(); t += std::chrono::milliseconds(50)) {
    const Vector3d p_W = motion.at(t).T_W_I.translation();
    farthest_m = std::max(farthest_m, p_W.x());
    ASSERT_GT(p_W.y(), -0.4);
    ASSERT_LT(p_W.y(), 1.4);
  }
  EXPECT_NEAR(farthest_m, 100.5, 0.3);
  EXPECT_LT((motion.at(motion.end()).T_W_I.translation() - Vector3d(0.0, 1.0, 1.3)).norm(), 0.05);
  EXPECT_LT(motion.at(motion.end()).v_W.norm(), 1e-6);
}

TEST(StairClimb, GainsEveryStepAndFollowsTheFlights) {
  const Stairs stairs{.flights = 4, .steps = 12};
  const Motion motion = stair_climb({.seed = 1, .stairs = stairs});
  const double climbed_m =
      motion.at(motion.end()).T_W_I.translation().z() - motion.at(motion.start()).T_W_I.translation().z();
  EXPECT_NEAR(climbed_m, 4 * 12 * 0.17, 0.03);
  for (Time t = motion.start(); t < motion.end(); t += std::chrono::milliseconds(50)) {
    const Vector3d p_W = motion.at(t).T_W_I.translation();
    ASSERT_GT(p_W.x(), -stairs.landing_m - 0.5 * stairs.well_m - 0.15);
    ASSERT_LT(p_W.x(), stairs.flight_run_m() + stairs.landing_m + 0.5 * stairs.well_m + 0.15);
    ASSERT_GT(p_W.y(), -0.15);
    ASSERT_LT(p_W.y(), stairs.well_m + 0.15);
    if (p_W.x() < 0.0 || p_W.x() > stairs.flight_run_m()) continue;
    // Above the line through the steps of the flight below one, whichever flight that is.
    const bool outward = p_W.y() < 0.5 * stairs.well_m;
    const double along = outward ? p_W.x() / stairs.flight_run_m() : 2.0 - p_W.x() / stairs.flight_run_m();
    const double above_m = p_W.z() - 1.3 - along * stairs.flight_rise_m();
    ASSERT_LT(std::abs(std::remainder(above_m, 2.0 * stairs.flight_rise_m())), 0.15);
  }
}

}  // namespace
}  // namespace pllit
