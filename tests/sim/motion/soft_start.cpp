#include <gtest/gtest.h>

#include "pllit/sim/motion/fit.hpp"
#include "sim/motion/checks.hpp"

namespace pllit {
namespace {

Motion winding() { return fit_motion(test::winding_path(30.0), kHandHeldFit)->motion; }

TEST(SoftStart, StandsExactlyAtTheFirstPose) {
  const Motion motion = winding();
  const Motion softly = motion.after_rest({.rest_s = 2.0, .ramp_s = 3.0});
  test::expect_exact_rest(softly, 2.0);
  EXPECT_EQ(softly.at(softly.start()).T_W_I.coeffs(), motion.at(motion.start()).T_W_I.coeffs());
}

TEST(SoftStart, KeepsDerivativesExact) {
  test::expect_exact_derivatives(winding().after_rest({.rest_s = 2.0, .ramp_s = 3.0}));
}

TEST(SoftStart, RisesWithoutAJumpInAcceleration) {
  const Motion softly = winding().after_rest({.rest_s = 2.0, .ramp_s = 1.5});
  const Duration step = std::chrono::microseconds(100);
  for (Time t = softly.start() + std::chrono::milliseconds(1900); t < softly.start() + std::chrono::seconds(4);
       t += step) {
    const MotionState before = softly.at(t), after = softly.at(t + step);
    ASSERT_LT((after.a_W - before.a_W).norm(), 2e-3);  // 5 m/s in 1.5 s needs a jerk of at most 5.8 * 5 / 1.5^2
    ASSERT_LT((after.omega_I - before.omega_I).norm(), 1e-4);
  }
}

TEST(SoftStart, OnlyDelaysWhatComesAfterIt) {
  const Motion motion = winding();
  const Motion softly = motion.after_rest({.rest_s = 2.0, .ramp_s = 3.0});
  EXPECT_EQ(softly.end() - motion.end(), std::chrono::milliseconds(3500));
  for (Time t = motion.start() + std::chrono::seconds(2); t < motion.end(); t += std::chrono::milliseconds(333)) {
    const MotionState early = motion.at(t), late = softly.at(t + std::chrono::milliseconds(3500));
    ASSERT_LT((early.T_W_I.translation() - late.T_W_I.translation()).norm(), 1e-9);
    ASSERT_LT((early.a_W - late.a_W).norm(), 1e-8);
    ASSERT_LT((early.omega_I - late.omega_I).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace pllit
