#include "pllit/sim/motion/vibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pllit/sim/motion/fit.hpp"
#include "sim/motion/checks.hpp"

namespace pllit {
namespace {

Motion winding() { return motion_along(test::winding_path(30.0), kHandHeldFit)->motion; }

TEST(Vibration, KeepsDerivativesExact) {
  test::expect_exact_derivatives(winding().with_vibration(hand_held_vibration(1)));
  test::expect_exact_derivatives(winding().with_vibration(vehicle_vibration(2)));
}

TEST(Vibration, LeavesRestExact) { test::expect_exact_rest(winding().with_vibration(vehicle_vibration(1)), 2.0); }

TEST(Vibration, FadesInWithoutAJump) {
  const Motion smooth = winding(), shaken = smooth.with_vibration(vehicle_vibration(3));
  const Duration step = std::chrono::microseconds(50);
  Vector3d last = Vector3d::Zero();
  for (Time t = smooth.start() + std::chrono::seconds(2); t < smooth.start() + std::chrono::seconds(5); t += step) {
    const Vector3d added = shaken.at(t).a_W - smooth.at(t).a_W;
    ASSERT_LT((added - last).norm(), 0.06);  // 80 Hz turns a few m/s2 by 2.5 % in 50 us
    last = added;
  }
}

TEST(Vibration, HasTheStatedSizeAtFullSpeed) {
  const VibrationConfig config{
      .full_speed_mps = 1.0,
      .bands = {{.low_hz = 5.0, .high_hz = 20.0, .acceleration_mps2 = 0.3, .angular_rate_rps = 0.05},
                {.low_hz = 20.0, .high_hz = 80.0, .acceleration_mps2 = 0.4, .angular_rate_rps = 0.12}}};
  const Vibration vibration(config, 0.2, std::vector<double>(400, 1e6));
  Vector3d acceleration = Vector3d::Zero(), rate = Vector3d::Zero();
  const int count = 64'000;
  for (int i = 0; i < count; ++i) {
    const VibrationState state = vibration.at(2.0 + 0.001 * i);
    acceleration += state.offset_acceleration_W.cwiseAbs2() / count;
    rate += state.angle_rate_I.cwiseAbs2() / count;
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(std::sqrt(acceleration[axis]), 0.5, 0.02);
    EXPECT_NEAR(std::sqrt(rate[axis]), 0.13, 0.005);
  }
}

TEST(Vibration, GrowsWithSpeed) {
  const auto strength = [](double speed_mps) {
    const Vibration vibration(vehicle_vibration(1), 0.2, std::vector<double>(50, speed_mps));
    return vibration.at(5.0).offset_W.norm();
  };
  EXPECT_EQ(strength(0.0), 0.0);
  EXPECT_NEAR(strength(0.2) / strength(0.1), 2.0, 0.01);
  EXPECT_NEAR(strength(8.0) / strength(800.0), std::numbers::sqrt2 / 2.0, 1e-3);
}

TEST(Vibration, IsTheSameForTheSameSeedOnly) {
  const auto offset = [](std::uint64_t seed) {
    const Motion motion = winding().with_vibration(hand_held_vibration(seed));
    return motion.at(motion.start() + std::chrono::seconds(15)).T_W_I.coeffs().eval();
  };
  EXPECT_EQ(offset(1), offset(1));
  EXPECT_NE(offset(1), offset(2));
}

}  // namespace
}  // namespace pllit
