#include "pllit/sim/motion/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pllit/sim/motion/walks.hpp"
#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

const Lane kRoomLane{.straight_x_m = 6.8, .straight_y_m = 2.2, .corner_radius_m = 2.0};

Motion random_motion(std::uint64_t seed) {
  Random random(seed);
  std::vector<SE3> controls;
  for (int i = 0; i < 40; ++i) controls.push_back(pose_from(exp_so3(0.8 * random.gaussian3()), random.gaussian3()));
  return Motion(Time(Duration(1'700'000'000'123'456'789)), std::chrono::milliseconds(250), controls);
}

std::vector<Motion> all_motions() {
  std::vector<Motion> motions;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    motions.push_back(random_motion(seed));
    motions.push_back(walk_along(kRoomLane, {.seed = seed, .duration_s = 40.0}));
    motions.push_back(fast_shake(kRoomLane, {.seed = seed, .duration_s = 40.0}));
  }
  return motions;
}

/// Times away from the ends, uneven against the spline's knots.
std::vector<Time> inner_times(const Motion& motion) {
  std::vector<Time> times;
  for (Time t = motion.start() + std::chrono::milliseconds(51); t < motion.end() - std::chrono::milliseconds(51);
       t += Duration(37'123'457))
    times.push_back(t);
  return times;
}

TEST(Motion, HasTheDerivativesThatDifferencesShow) {
  const Duration h = std::chrono::microseconds(200);
  const double two_h_s = 2.0 * to_seconds(h);
  for (const Motion& motion : all_motions()) {
    for (const Time t : inner_times(motion)) {
      const MotionState before = motion.at(t - h), now = motion.at(t), after = motion.at(t + h);
      const Vector3d velocity = (after.T_W_I.translation() - before.T_W_I.translation()) / two_h_s;
      const Vector3d acceleration = (after.v_W - before.v_W) / two_h_s;
      const Vector3d rate = log_so3(before.T_W_I.asSO3().inverse() * after.T_W_I.asSO3()) / two_h_s;
      ASSERT_LT((velocity - now.v_W).norm(), 1e-5);
      ASSERT_LT((acceleration - now.a_W).norm(), 1e-5 * (1.0 + now.a_W.norm()));
      ASSERT_LT((rate - now.omega_I).norm(), 1e-5 * (1.0 + now.omega_I.norm()));
    }
  }
}

TEST(Motion, IsSmoothAcrossItsKnots) {
  const Motion motion = random_motion(5);
  for (Time knot = motion.start() + std::chrono::milliseconds(250); knot < motion.end();
       knot += std::chrono::milliseconds(250)) {
    const MotionState before = motion.at(knot - Duration(1)), after = motion.at(knot);
    EXPECT_LT((after.T_W_I.translation() - before.T_W_I.translation()).norm(), 1e-7);
    EXPECT_LT(log_so3(before.T_W_I.asSO3().inverse() * after.T_W_I.asSO3()).norm(), 1e-7);
    EXPECT_LT((after.v_W - before.v_W).norm(), 1e-6);
    EXPECT_LT((after.a_W - before.a_W).norm(), 1e-5);
    EXPECT_LT((after.omega_I - before.omega_I).norm(), 1e-5);
  }
}

TEST(Motion, FollowsControlsOnALineAtTheirSpeed) {
  std::vector<SE3> controls;
  for (int i = 0; i < 20; ++i) controls.push_back(pose_from(exp_so3({0.0, 0.0, 0.1 * i}), {0.3 * i, 0.0, 0.0}));
  const Motion motion(Time{}, std::chrono::milliseconds(100), controls);
  for (const Time t : inner_times(motion)) {
    const MotionState state = motion.at(t);
    const double i = 2.0 + to_seconds(t) / 0.1;
    EXPECT_LT((state.T_W_I.translation() - Vector3d(0.3 * i, 0.0, 0.0)).norm(), 1e-12);
    EXPECT_LT((log_so3(state.T_W_I.asSO3() * exp_so3({0.0, 0.0, -0.1 * i}))).norm(), 1e-12);
    EXPECT_LT((state.v_W - Vector3d(3.0, 0.0, 0.0)).norm(), 1e-12);
    EXPECT_LT(state.a_W.norm(), 1e-10);
    EXPECT_LT((state.omega_I - Vector3d(0.0, 0.0, 1.0)).norm(), 1e-12);
  }
}

TEST(Motion, HoldsItsEndsOutsideItsTime) {
  const Motion motion = random_motion(6);
  const auto second = std::chrono::seconds(1);
  EXPECT_EQ(motion.at(motion.start() - second).T_W_I.coeffs(), motion.at(motion.start()).T_W_I.coeffs());
  EXPECT_EQ(motion.at(motion.end() + second).T_W_I.coeffs(), motion.at(motion.end()).T_W_I.coeffs());
}

TEST(Walks, StartAtExactRest) {
  for (const Motion& motion : {walk_along(kRoomLane, {.seed = 4}), fast_shake(kRoomLane, {.seed = 4})}) {
    const SE3 first = motion.at(motion.start()).T_W_I;
    for (Time t = motion.start(); t <= motion.start() + std::chrono::seconds(2); t += std::chrono::milliseconds(5)) {
      const MotionState state = motion.at(t);
      ASSERT_EQ(state.T_W_I.coeffs(), first.coeffs());
      ASSERT_EQ(state.v_W, Vector3d::Zero());
      ASSERT_EQ(state.a_W, Vector3d::Zero());
      ASSERT_EQ(state.omega_I, Vector3d::Zero());
    }
    EXPECT_GT(motion.at(motion.start() + std::chrono::seconds(4)).v_W.norm(), 0.1);
  }
}

TEST(Walks, GoAtThePaceAskedForAndTurnWithTheLane) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Motion motion = walk_along(kRoomLane, {.seed = seed, .duration_s = 63.5, .speed_mps = 0.8});
    double length_m = 0.0, turn_rad = 0.0, sharpest_turn_rps = 0.0;
    const double step_s = 0.01;
    for (Time t = motion.start(); t < motion.end(); t += from_seconds(step_s)) {
      const MotionState state = motion.at(t);
      const double yaw_rate_rps = state.T_W_I.asSO3().act(state.omega_I).z();
      length_m += state.v_W.head<2>().norm() * step_s;
      turn_rad += yaw_rate_rps * step_s;
      sharpest_turn_rps = std::max(sharpest_turn_rps, std::abs(yaw_rate_rps));
    }
    EXPECT_NEAR(length_m / 60.0, 0.8, 0.12) << seed;
    // 48 m of a lap of 30.6 m; turns come in quarters, and one may be glancing aside at the end.
    EXPECT_NEAR(std::abs(turn_rad), 2.0 * std::numbers::pi * 48.0 / 30.6, 1.7) << seed;
    EXPECT_LT(sharpest_turn_rps, 1.2) << seed;
  }
}

TEST(Walks, KeepToTheLane) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Lane straight{.straight_x_m = std::numeric_limits<double>::infinity()};
    for (const Motion& motion :
         {walk_along(straight, {.seed = seed, .duration_s = 60.0}), fast_shake(straight, {.seed = seed})}) {
      for (Time t = motion.start(); t < motion.end(); t += std::chrono::milliseconds(20)) {
        const Vector3d p_W = motion.at(t).T_W_I.translation();
        ASSERT_LT(std::abs(p_W.y()), kLaneHalfWidth_m);
        ASSERT_LT(std::abs(p_W.z() - straight.height_m), kLaneHalfWidth_m);
      }
    }
  }
}

TEST(Walks, DifferFromSeedToSeedAndNotOtherwise) {
  const auto end_of = [](std::uint64_t seed) {
    const Motion motion = walk_along(kRoomLane, {.seed = seed});
    return motion.at(motion.end()).T_W_I.coeffs().eval();
  };
  EXPECT_EQ(end_of(1), end_of(1));
  EXPECT_NE(end_of(1), end_of(2));
}

TEST(FastShake, PeaksBetweenTwoAndThreeRadiansASecond) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Motion motion = fast_shake(kRoomLane, {.seed = seed, .duration_s = 60.0});
    double peak_rps = 0.0;
    for (Time t = motion.start(); t < motion.end(); t += std::chrono::milliseconds(10))
      peak_rps = std::max(peak_rps, motion.at(t).omega_I.norm());
    EXPECT_GT(peak_rps, 2.0) << seed;
    EXPECT_LT(peak_rps, 3.0) << seed;
  }
}

}  // namespace
}  // namespace pllit
