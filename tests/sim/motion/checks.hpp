// What every motion has to keep.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pllit/sim/motion/motion.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit::test {

/// Velocity, acceleration and angular rate against central differences at uneven times over all of a motion.
inline void expect_exact_derivatives(const Motion& motion) {
  const Duration h = std::chrono::microseconds(20);
  const double two_h_s = 2.0 * to_seconds(h);
  const Duration step = std::max(Duration(7'123'457), (motion.end() - motion.start()) / 5000);
  for (Time t = motion.start() + Duration(1'000'003); t < motion.end() - h; t += step) {
    const MotionState before = motion.at(t - h), now = motion.at(t), after = motion.at(t + h);
    const Vector3d velocity = (after.T_W_I.translation() - before.T_W_I.translation()) / two_h_s;
    const Vector3d acceleration = (after.v_W - before.v_W) / two_h_s;
    const Vector3d rate = log_so3(before.T_W_I.asSO3().inverse() * after.T_W_I.asSO3()) / two_h_s;
    ASSERT_LT((velocity - now.v_W).norm(), 1e-5 * (1.0 + now.v_W.norm())) << to_seconds(t - motion.start());
    ASSERT_LT((acceleration - now.a_W).norm(), 2e-5 * (1.0 + now.a_W.norm())) << to_seconds(t - motion.start());
    ASSERT_LT((rate - now.omega_I).norm(), 1e-5 * (1.0 + now.omega_I.norm())) << to_seconds(t - motion.start());
  }
}

inline void expect_exact_rest(const Motion& motion, double rest_s) {
  const SE3 first = motion.at(motion.start()).T_W_I;
  for (Time t = motion.start(); t <= motion.start() + from_seconds(rest_s); t += std::chrono::milliseconds(5)) {
    const MotionState state = motion.at(t);
    ASSERT_EQ(state.T_W_I.coeffs(), first.coeffs());
    ASSERT_EQ(state.v_W, Vector3d::Zero());
    ASSERT_EQ(state.a_W, Vector3d::Zero());
    ASSERT_EQ(state.omega_I, Vector3d::Zero());
  }
}

struct Magnitudes {
  std::vector<double> speed_mps, acceleration_mps2, rate_rps;  ///< ascending
  double percentile_99(const std::vector<double>& values) const { return values[values.size() * 99 / 100]; }
};

inline Magnitudes magnitudes(const Motion& motion) {
  Magnitudes all;
  for (Time t = motion.start(); t < motion.end(); t += std::chrono::milliseconds(20)) {
    const MotionState state = motion.at(t);
    all.speed_mps.push_back(state.v_W.norm());
    all.acceleration_mps2.push_back(state.a_W.norm());
    all.rate_rps.push_back(state.omega_I.norm());
  }
  for (auto* values : {&all.speed_mps, &all.acceleration_mps2, &all.rate_rps}) std::ranges::sort(*values);
  return all;
}

/// A smooth path that bends, climbs and tilts: poses at 10 Hz, x of I along the way.
inline Trajectory winding_path(double duration_s) {
  Trajectory path;
  for (int i = 0; i <= static_cast<int>(duration_s * 10.0); ++i) {
    const double t = 0.1 * i;
    const double heading = 0.8 * std::sin(0.2 * t);
    const Vector3d p_W = path.empty()
                             ? Vector3d(3.0, -2.0, 1.0)
                             : Vector3d(path.back().T_W_I.translation() +
                                        0.5 * Vector3d(std::cos(heading), std::sin(heading), 0.02 * std::cos(0.3 * t)));
    path.push_back(
        {time_from_parts(1'600'000'000, 0) + from_seconds(t),
         pose_from(exp_so3({0.0, 0.0, heading}) * exp_so3({0.03 * std::sin(0.5 * t), 0.02 * std::cos(0.4 * t), 0.0}),
                   p_W)});
  }
  return path;
}

}  // namespace pllit::test
