#include "pllit/sim/motion/imu.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "pllit/sim/motion/fit.hpp"
#include "pllit/sim/motion/imu_models.hpp"
#include "pllit/sim/motion/walks.hpp"
#include "sim/motion/checks.hpp"
#include "sim/statistics.hpp"

namespace pllit {
namespace {

using test::chi_square_deviation;
using test::mean_deviation;

const Lane kLane{.straight_x_m = 6.8, .straight_y_m = 2.2, .corner_radius_m = 2.0};
const ImuNoise kNoNoise{.gyro_density = 0.0,
                        .accel_density = 0.0,
                        .gyro_bias_walk = 0.0,
                        .accel_bias_walk = 0.0,
                        .gyro_bias_sigma = 0.0,
                        .accel_bias_sigma = 0.0};

Motion at_rest(double duration_s) { return walk_along(kLane, {.duration_s = duration_s, .rest_s = duration_s}); }

std::vector<ImuSample> samples_of(const Motion& motion, double rate_hz, const ImuNoise& noise, std::uint64_t seed) {
  std::vector<ImuSample> samples;
  for (ImuStream imu(motion.start(), rate_hz, noise, seed); imu.next_time() <= motion.end();)
    samples.push_back(imu.next(motion));
  return samples;
}

struct Navigation {
  Eigen::Quaterniond q_W_I;
  Vector3d v_W, p_W;
};

Navigation plus(const Navigation& a, const Navigation& slope, double h) {
  return {Eigen::Quaterniond(a.q_W_I.coeffs() + h * slope.q_W_I.coeffs()), a.v_W + h * slope.v_W,
          a.p_W + h * slope.p_W};
}

Navigation slope_of(const Navigation& x, const ImuSample& imu) {
  const Eigen::Quaterniond rate(0.0, imu.gyro_rps.x(), imu.gyro_rps.y(), imu.gyro_rps.z());
  const Eigen::Quaterniond q_dot((x.q_W_I * rate).coeffs() * 0.5);
  return {q_dot, x.q_W_I.normalized() * imu.accel_mps2 - Vector3d(0.0, 0.0, kStandardGravity_mps2), x.v_W};
}

/// Runge-Kutta over two sample intervals at a time: the sample between is the value in the middle.
Navigation integrated(Navigation x, const std::vector<ImuSample>& imu) {
  for (std::size_t i = 0; i + 2 < imu.size(); i += 2) {
    const double h = to_seconds(imu[i + 2].time - imu[i].time);
    const Navigation k1 = slope_of(x, imu[i]);
    const Navigation k2 = slope_of(plus(x, k1, 0.5 * h), imu[i + 1]);
    const Navigation k3 = slope_of(plus(x, k2, 0.5 * h), imu[i + 1]);
    const Navigation k4 = slope_of(plus(x, k3, h), imu[i + 2]);
    x = plus(plus(plus(plus(x, k1, h / 6.0), k2, h / 3.0), k3, h / 3.0), k4, h / 6.0);
    x.q_W_I.normalize();
  }
  return x;
}

struct Drift {
  double position_m, rotation_deg, velocity_mps;
};

Drift drift_of(const Motion& motion, double rate_hz) {
  const MotionState first = motion.at(motion.start());
  std::vector<ImuSample> samples = samples_of(motion, rate_hz, kNoNoise, 1);
  if (samples.size() % 2 == 0) samples.pop_back();  // pairs of intervals
  const MotionState last = motion.at(samples.back().time);
  const Navigation end = integrated({first.T_W_I.quat(), first.v_W, first.T_W_I.translation()}, samples);
  return {(end.p_W - last.T_W_I.translation()).norm(),
          end.q_W_I.angularDistance(last.T_W_I.quat()) * 180.0 / std::numbers::pi, (end.v_W - last.v_W).norm()};
}

TEST(ExactImu, IntegratesBackToTheTruthAt1000Hz) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const Motion& motion : {walk_along(kLane, {.seed = seed, .duration_s = 10.0}),
                                 fast_shake(kLane, {.seed = seed, .duration_s = 10.0})}) {
      const Drift drift = drift_of(motion, 1000.0);
      EXPECT_LT(drift.position_m, 1e-5);
      EXPECT_LT(drift.rotation_deg, 1e-6);
      EXPECT_LT(drift.velocity_mps, 1e-5);
    }
  }
}

TEST(ExactImu, IntegratesBackToTheTruthAt200Hz) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const Motion& motion : {walk_along(kLane, {.seed = seed, .duration_s = 10.0}),
                                 fast_shake(kLane, {.seed = seed, .duration_s = 10.0})}) {
      const Drift drift = drift_of(motion, 200.0);
      EXPECT_LT(drift.position_m, 1e-3);
      EXPECT_LT(drift.rotation_deg, 1e-3);
      EXPECT_LT(drift.velocity_mps, 1e-3);
    }
  }
}

TEST(ExactImu, IntegratesBackToTheTruthAlongAFittedPathAt200Hz) {
  for (const FitConfig& config : {kHandHeldFit, kCarFit}) {
    const Drift drift = drift_of(motion_along(test::winding_path(8.0), config)->motion, 200.0);
    EXPECT_LT(drift.position_m, 1e-3);
    EXPECT_LT(drift.rotation_deg, 1e-3);
  }
}

// What limits it: Runge-Kutta's error grows with the fourth power of frequency times step, and from half the sample
// rate on (two intervals make a step) nothing can be integrated.
TEST(ExactImu, IntegratesBackToTheTruthThroughVibration) {
  const Motion motion = motion_along(test::winding_path(8.0), kHandHeldFit)->motion;
  for (const VibrationConfig& vibration : {hand_held_vibration(1), vehicle_vibration(1)}) {
    const Motion shaken = motion.with_vibration(vibration);
    const Drift coarse = drift_of(shaken, 200.0), fine = drift_of(shaken, 1000.0);
    EXPECT_LT(coarse.position_m, 1e-3);
    EXPECT_LT(coarse.rotation_deg, 1e-3);
    EXPECT_LT(fine.position_m, 1e-6);
    EXPECT_LT(fine.rotation_deg, 1e-5);
  }
}

TEST(ExactImu, ShowsGravityUpwardsAtRest) {
  const Motion motion = at_rest(3.0);
  const MotionState state = motion.at(motion.start());
  const ImuSample sample = exact_imu(state, motion.start());
  EXPECT_EQ(sample.gyro_rps, Vector3d::Zero());
  EXPECT_LT((state.T_W_I.asSO3().act(sample.accel_mps2) - Vector3d(0.0, 0.0, 9.80665)).norm(), 1e-12);
}

TEST(ImuStream, StampsItsSamplesEvenlyAtAnyRate) {
  const Motion motion = at_rest(30.0);
  for (const double rate_hz : {10.0, 123.0, 1000.0}) {
    const auto samples = samples_of(motion, rate_hz, kNoNoise, 1);
    ASSERT_EQ(samples.size(), static_cast<std::size_t>(30.0 * rate_hz) + 1);
    for (std::size_t i = 0; i < samples.size(); ++i)
      ASSERT_NEAR(to_seconds(samples[i].time - motion.start()), static_cast<double>(i) / rate_hz, 1e-9);
  }
}

TEST(ImuStream, HasTheStatedWhiteNoiseAtEveryRate) {
  ImuNoise noise = kNoNoise;
  noise.gyro_density = 0.0003;
  noise.accel_density = 0.002;
  const Motion motion = at_rest(20.0);
  for (const double rate_hz : {50.0, 200.0, 1000.0}) {
    const ImuSample exact = exact_imu(motion.at(motion.start()), motion.start());
    std::vector<double> gyro, accel;
    for (const ImuSample& sample : samples_of(motion, rate_hz, noise, 7)) {
      for (int axis = 0; axis < 3; ++axis) {
        gyro.push_back((sample.gyro_rps - exact.gyro_rps)[axis] / (0.0003 * std::sqrt(rate_hz)));
        accel.push_back((sample.accel_mps2 - exact.accel_mps2)[axis] / (0.002 * std::sqrt(rate_hz)));
      }
    }
    for (const auto& values : {gyro, accel}) {
      EXPECT_LT(std::abs(chi_square_deviation(values)), 4.0) << rate_hz;
      EXPECT_LT(std::abs(mean_deviation(values)), 4.0) << rate_hz;
    }
  }
}

TEST(ImuStream, WalksItsBiasesByTheStatedDensity) {
  ImuNoise noise = kNoNoise;
  noise.gyro_bias_walk = 2e-5;
  noise.accel_bias_walk = 3e-4;
  const Motion motion = at_rest(10.0);
  std::vector<double> gyro, accel;  // over whole walks of 10 s, one a seed
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    ImuStream imu(motion.start(), 20.0, noise, seed);
    while (imu.next_time() < motion.end()) imu.next(motion);
    for (int axis = 0; axis < 3; ++axis) {
      gyro.push_back(imu.bias().gyro_rps[axis] / (2e-5 * std::sqrt(10.0)));
      accel.push_back(imu.bias().accel_mps2[axis] / (3e-4 * std::sqrt(10.0)));
    }
  }
  for (const auto& values : {gyro, accel}) {
    EXPECT_LT(std::abs(chi_square_deviation(values)), 4.0);
    EXPECT_LT(std::abs(mean_deviation(values)), 4.0);
  }
}

TEST(ImuStream, DrawsItsFirstBiasesFromTheirSigmas) {
  std::vector<double> gyro, accel;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    const ImuNoise noise{.gyro_bias_sigma = 0.02, .accel_bias_sigma = 0.3};
    const ImuStream imu(Time{}, 100.0, noise, seed);
    for (int axis = 0; axis < 3; ++axis) {
      gyro.push_back(imu.bias().gyro_rps[axis] / 0.02);
      accel.push_back(imu.bias().accel_mps2[axis] / 0.3);
    }
  }
  for (const auto& values : {gyro, accel}) {
    EXPECT_LT(std::abs(chi_square_deviation(values)), 4.0);
    EXPECT_LT(std::abs(mean_deviation(values)), 4.0);
  }
}

TEST(ImuStream, AddsTheGivenBias) {
  const Motion motion = at_rest(3.0);
  const ImuBias bias{.gyro_rps = {0.01, -0.02, 0.03}, .accel_mps2 = {0.1, 0.2, -0.3}};
  ImuStream imu(motion.start(), 100.0, kNoNoise, 1, bias);
  const ImuSample sample = imu.next(motion), exact = exact_imu(motion.at(motion.start()), motion.start());
  EXPECT_LT((sample.gyro_rps - exact.gyro_rps - bias.gyro_rps).norm(), 1e-15);
  EXPECT_LT((sample.accel_mps2 - exact.accel_mps2 - bias.accel_mps2).norm(), 1e-14);
}

Motion shaken(std::uint64_t seed) { return fast_shake(kLane, {.seed = seed, .duration_s = 20.0}); }

std::vector<ImuSample> samples_of(const Motion& motion, const ImuModel& model, std::uint64_t seed) {
  std::vector<ImuSample> samples;
  for (ImuStream imu(motion.start(), model, seed); imu.next_time() <= motion.end();)
    samples.push_back(imu.next(motion));
  return samples;
}

TEST(ImuStream, MultipliesTheTruthByScaleAndMisalignment) {
  const ImuModel model{
      .noise = kNoNoise, .gyro_scale_sigma = 0.01, .accel_scale_sigma = 0.02, .misalignment_sigma_rad = 0.005};
  const Motion motion = shaken(1);
  ImuStream imu(motion.start(), model, 5);
  while (imu.next_time() < motion.end()) {
    const ImuSample exact = exact_imu(motion.at(imu.next_time()), imu.next_time());
    const ImuSample sample = imu.next(motion);
    ASSERT_LT((sample.gyro_rps - imu.gyro_distortion() * exact.gyro_rps).norm(), 1e-14);
    ASSERT_LT((sample.accel_mps2 - imu.accel_distortion() * exact.accel_mps2).norm(), 1e-13);
  }
}

TEST(ImuStream, DrawsScaleAndMisalignmentFromTheirSigmas) {
  std::vector<double> scales, angles;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const ImuModel model{.gyro_scale_sigma = 0.01, .accel_scale_sigma = 0.02, .misalignment_sigma_rad = 0.005};
    const ImuStream imu(Time{}, model, seed);
    for (int row = 0; row < 3; ++row) {
      scales.push_back((imu.gyro_distortion()(row, row) - 1.0) / 0.01);
      scales.push_back((imu.accel_distortion()(row, row) - 1.0) / 0.02);
      for (const int column : {(row + 1) % 3, (row + 2) % 3}) {
        angles.push_back(imu.gyro_distortion()(row, column) / 0.005);
        angles.push_back(imu.accel_distortion()(row, column) / 0.005);
      }
    }
  }
  for (const auto& values : {scales, angles}) {
    EXPECT_LT(std::abs(chi_square_deviation(values)), 4.0);
    EXPECT_LT(std::abs(mean_deviation(values)), 4.0);
  }
}

TEST(ImuStream, RoundsToWholeCounts) {
  const ImuModel exact{.noise = kNoNoise};
  ImuModel coarse = exact;
  coarse.gyro_lsb_rps = 0.01;
  coarse.accel_lsb_mps2 = 0.05;
  const Motion motion = shaken(2);
  const auto smooth = samples_of(motion, exact, 1), rounded = samples_of(motion, coarse, 1);
  ASSERT_EQ(smooth.size(), rounded.size());
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double counts = rounded[i].gyro_rps[axis] / 0.01;
      ASSERT_NEAR(counts, std::round(counts), 1e-9);
    }
    ASSERT_LE((smooth[i].gyro_rps - rounded[i].gyro_rps).cwiseAbs().maxCoeff(), 0.005 + 1e-12);
    ASSERT_LE((smooth[i].accel_mps2 - rounded[i].accel_mps2).cwiseAbs().maxCoeff(), 0.025 + 1e-12);
  }
}

TEST(ImuStream, SaturatesAtItsRange) {
  ImuModel model{.noise = kNoNoise};
  model.gyro_range_rps = 1.0;
  model.accel_range_mps2 = 9.0;
  const Motion motion = shaken(3);
  const auto free = samples_of(motion, {.noise = kNoNoise}, 1), held = samples_of(motion, model, 1);
  int saturated = 0;
  for (std::size_t i = 0; i < free.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(held[i].gyro_rps[axis], std::clamp(free[i].gyro_rps[axis], -1.0, 1.0));
      ASSERT_EQ(held[i].accel_mps2[axis], std::clamp(free[i].accel_mps2[axis], -9.0, 9.0));
      saturated += std::abs(free[i].gyro_rps[axis]) > 1.0;
    }
  EXPECT_GT(saturated, 100);
}

/// Allan deviation of one axis over averages of `count` samples.
double allan_deviation(const std::vector<double>& values, std::size_t count) {
  std::vector<double> means;
  for (std::size_t i = 0; i + count <= values.size(); i += count) {
    double sum = 0.0;
    for (std::size_t k = i; k < i + count; ++k) sum += values[k];
    means.push_back(sum / static_cast<double>(count));
  }
  double squares = 0.0;
  for (std::size_t i = 1; i < means.size(); ++i) squares += (means[i] - means[i - 1]) * (means[i] - means[i - 1]);
  return std::sqrt(0.5 * squares / static_cast<double>(means.size() - 1));
}

TEST(ImuStream, HasTheAllanDeviationOfItsDensities) {
  ImuModel model{.noise = kNoNoise, .rate_hz = 100.0};
  model.noise.gyro_density = 0.001;    // over 1 s
  model.noise.accel_bias_walk = 0.01;  // sqrt(tau / 3) times as much
  std::vector<double> gyro, accel;
  const Motion motion = at_rest(4.0);
  const ImuSample exact = exact_imu(motion.at(motion.start()), motion.start());
  ImuStream imu(motion.start(), model, 3);
  for (int i = 0; i < 200'000; ++i) {  // the motion holds its end: a rest of 2000 s
    const ImuSample sample = imu.next(motion);
    gyro.push_back(sample.gyro_rps.x() - exact.gyro_rps.x());
    accel.push_back(sample.accel_mps2.x() - exact.accel_mps2.x());
  }
  for (const std::size_t seconds : {1U, 4U, 16U}) {
    const double tau_s = static_cast<double>(seconds);
    EXPECT_NEAR(allan_deviation(gyro, 100 * seconds) / (0.001 / std::sqrt(tau_s)), 1.0, 0.25) << tau_s;
    EXPECT_NEAR(allan_deviation(accel, 100 * seconds) / (0.01 * std::sqrt(tau_s / 3.0)), 1.0, 0.25) << tau_s;
  }
}

TEST(ImuStream, GivesTheSameSamplesForTheSameSeedOnly) {
  const Motion motion = shaken(4);
  const ImuModel model = *imu_model("bmi088");
  const auto first = samples_of(motion, model, 9), again = samples_of(motion, model, 9),
             other = samples_of(motion, model, 10);
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].gyro_rps, again[i].gyro_rps);
    ASSERT_EQ(first[i].accel_mps2, again[i].accel_mps2);
  }
  EXPECT_NE(first.back().gyro_rps, other.back().gyro_rps);
}

}  // namespace
}  // namespace pllit
