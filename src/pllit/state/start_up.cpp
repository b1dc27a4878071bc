#include "pllit/state/start_up.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <format>
#include <vector>

namespace pllit {

namespace ix = error_index;

namespace {

constexpr double standard_gravity = 9.80665;

Vector3d mean_accel(std::span<const ImuSample> imu) {
  Vector3d sum = Vector3d::Zero();
  for (const ImuSample& sample : imu) sum += sample.accel_mps2;
  return sum / static_cast<double>(imu.size());
}

Vector3d mean_rate(std::span<const ImuSample> imu) {
  Vector3d sum = Vector3d::Zero();
  for (const ImuSample& sample : imu) sum += sample.gyro_rps;
  return sum / static_cast<double>(imu.size());
}

double span_s(std::span<const ImuSample> imu) { return to_seconds(imu.back().time - imu.front().time); }

/// Mean specific force in the frame of the first sample, the rotation since then taken out with the gyroscope.
Vector3d mean_accel_in_first_frame(std::span<const ImuSample> imu) {
  SO3 R_first_now = SO3::Identity();
  Vector3d sum = imu.front().accel_mps2;
  for (std::size_t i = 1; i < imu.size(); ++i) {
    const double dt = to_seconds(imu[i].time - imu[i - 1].time);
    R_first_now = R_first_now * exp_so3(0.5 * dt * (imu[i].gyro_rps + imu[i - 1].gyro_rps));
    sum += R_first_now.act(imu[i].accel_mps2);
  }
  return sum / static_cast<double>(imu.size());
}

/// Largest standard deviation of an axis of the gyroscope, over the means of `blocks` equal parts of the stretch.
double gyro_spread(std::span<const ImuSample> imu, std::size_t blocks) {
  const Vector3d mean = mean_rate(imu);
  Vector3d squares = Vector3d::Zero();
  for (std::size_t i = 0; i < blocks; ++i) {
    const std::size_t begin = i * imu.size() / blocks, end = (i + 1) * imu.size() / blocks;
    squares += (mean_rate(imu.subspan(begin, end - begin)) - mean).cwiseAbs2();
  }
  return std::sqrt(squares.maxCoeff() / static_cast<double>(blocks));
}

/// Rotation that takes `up_I` to z and keeps the IMU's x axis in the x-z plane of W (heading zero).
SO3 level(const Vector3d& up_I) {
  const Vector3d z = up_I.normalized();
  const Vector3d forward = std::abs(z.x()) < 0.99 ? Vector3d::UnitX() : Vector3d(-Vector3d::UnitZ());
  const Vector3d x = (forward - z * z.dot(forward)).normalized();
  Matrix3d R_W_I;
  R_W_I << x.transpose(), z.cross(x).transpose(), z.transpose();
  return rotation_from(Eigen::Quaterniond(R_W_I));
}

/// Whether the mean rate is a bias: in the half window between the two halves' centres a real rotation would have
/// turned the direction of gravity by as much, a bias has not.
bool gravity_contradicts_rotation(std::span<const ImuSample> imu, const Vector3d& rate_across_rps) {
  const auto half = imu.size() / 2;
  const auto first = imu.first(half), second = imu.subspan(half);
  const Vector3d u1 = mean_accel(first).normalized(), u2 = mean_accel(second).normalized();
  const double dt = 0.5 * span_s(imu);
  const Vector3d predicted = -rate_across_rps.cross(0.5 * (u1 + u2)) * dt;  // the world turns the other way
  return (u2 - u1 - predicted).norm() > 0.5 * predicted.norm() && (u2 - u1).norm() < 0.3 * predicted.norm();
}

/// Adds the knowledge of gravity's length, as a scalar measurement: it fixes the accelerometer bias along the vertical.
void know_gravity_length(Estimate& estimate, double gravity_mps2, double sigma_mps2) {
  const Vector3d g = estimate.mean.gravity_W;
  Vector18 h = Vector18::Zero();
  h.segment<3>(ix::g) = g.normalized();
  const Vector18 Ph = estimate.covariance * h;
  const double variance = h.dot(Ph) + sigma_mps2 * sigma_mps2;
  const Vector18 gain = Ph / variance;
  estimate.mean = boxplus(estimate.mean, gain * (gravity_mps2 - g.norm()));
  estimate.covariance -= gain * Ph.transpose();
}

Estimate initial_estimate(std::span<const ImuSample> imu, const Stillness& stillness, const ImuNoise& noise,
                          const StartUpConfig& config) {
  constexpr double definition = 1e-5;  // rad, m: the first pose defines W; not zero, so that P stays positive definite
  const bool still = stillness.still;
  const double length_s = span_s(imu);
  const Vector3d force_I = still ? stillness.mean_accel_mps2 : mean_accel_in_first_frame(imu);

  Estimate start;
  start.mean.time = imu.front().time;
  start.mean.R_W_I = level(force_I);
  start.mean.gravity_W = Vector3d(0.0, 0.0, -force_I.norm());
  if (still) start.mean.gyro_bias = stillness.mean_rate_rps;

  const auto square = [](double x) { return x * x; };
  const double ba = square(noise.accel_bias_sigma);
  const double accel = still ? square(noise.accel_density) / length_s : square(config.moving_accel_mps2);
  const double bg = still
                        ? square(noise.gyro_density) / length_s + square(noise.gyro_bias_walk) * length_s + square(5e-5)
                        : square(noise.gyro_bias_sigma);
  const double v = still ? square(0.01) : square(config.moving_speed_mps);
  Vector18 variances;
  variances << Vector6::Constant(square(definition)), Vector3d::Constant(v), Vector3d::Constant(bg),
      Vector3d::Constant(ba), Vector3d::Constant(ba + accel);
  start.covariance = variances.asDiagonal();
  // g = -R (a - b_a): the two errors go together until the rig tilts.
  const Matrix3d R = start.mean.R_W_I.rotation();
  start.covariance.block<3, 3>(ix::g, ix::ba) = R * ba;
  start.covariance.block<3, 3>(ix::ba, ix::g) = R.transpose() * ba;
  know_gravity_length(start, config.gravity_mps2, config.gravity_sigma_mps2);
  return start;
}

std::string describe(const Stillness& s) {
  return std::format("gyro spread {:.4f} rad/s, accelerometer spread {:.3f} m/s2, mean rate {:.4f} rad/s",
                     s.gyro_spread_rps, s.accel_spread_mps2, s.mean_rate_rps.norm());
}

}  // namespace

double mps2_per(AccelUnit unit) { return unit == AccelUnit::g ? standard_gravity : 1.0; }

Expected<AccelUnit> accel_unit_of(std::span<const ImuSample> imu, AccelUnit configured) {
  if (configured != AccelUnit::automatic) return configured;
  const double length = mean_accel_in_first_frame(imu).norm();
  if (length > 0.8 && length < 1.2) return AccelUnit::g;
  if (length > 8.0 && length < 11.5) return AccelUnit::mps2;
  return input_error(
      std::format("the accelerometer's mean over the first {:.1f} s is {:.3f}, which is neither about 1 (g) nor about "
                  "9.8 (m/s2); set "
                  "input.accel_unit to g or m_s2, or start the recording where the rig is not accelerating",
                  span_s(imu), length));
}

Stillness measure_stillness(std::span<const ImuSample> imu, const StartUpConfig& config) {
  Stillness s;
  s.mean_rate_rps = mean_rate(imu);
  s.mean_accel_mps2 = mean_accel(imu);
  Vector3d accel_squares = Vector3d::Zero();
  for (const ImuSample& sample : imu) accel_squares += (sample.accel_mps2 - s.mean_accel_mps2).cwiseAbs2();
  s.accel_spread_mps2 = std::sqrt(accel_squares.maxCoeff() / static_cast<double>(imu.size()));
  s.gyro_spread_rps = gyro_spread(imu, imu.size());
  s.slow_spread_rps = gyro_spread(imu, std::min<std::size_t>(10, imu.size()));
  if (s.gyro_spread_rps > config.still_gyro_spread_rps || s.accel_spread_mps2 > config.still_accel_spread_mps2 ||
      s.slow_spread_rps > config.still_slow_spread_rps)
    return s;
  s.quiet = true;

  const Vector3d up_I = s.mean_accel_mps2.normalized();
  const double rate_about_vertical = s.mean_rate_rps.dot(up_I);
  const Vector3d rate_across = s.mean_rate_rps - rate_about_vertical * up_I;
  if (std::abs(rate_about_vertical) > config.still_rate_rps) return s;
  if (rate_across.norm() > config.still_rate_rps) {
    s.gravity_confirms_bias = gravity_contradicts_rotation(imu, rate_across);
    if (!s.gravity_confirms_bias) return s;
  }
  s.still = true;
  return s;
}

Expected<std::optional<Start>> start_up(std::span<const ImuSample> imu, const ImuNoise& noise,
                                        const StartUpConfig& config) {
  if (imu.size() < 5 || span_s(imu) < config.window_s) return std::optional<Start>{};
  const auto unit = accel_unit_of(imu, config.unit);
  if (!unit) return std::unexpected(unit.error());

  std::vector<ImuSample> si(imu.begin(), imu.end());
  for (ImuSample& sample : si) sample.accel_mps2 *= mps2_per(*unit);
  Stillness stillness = measure_stillness(si, config);
  if (config.mode == StartMode::still && !stillness.still)
    return input_error(
        std::format("start.mode is still, but the rig moves in the first {:.1f} s ({}); set start.mode to auto",
                    span_s(imu), describe(stillness)));
  if (config.mode == StartMode::moving) stillness.still = false;

  Start start;
  start.estimate = initial_estimate(si, stillness, noise, config);
  start.still = stillness.still;
  start.stillness = stillness;
  start.unit = *unit;
  start.report = std::format("{} start, accelerometer in {} ({}{})", start.still ? "still" : "moving",
                             *unit == AccelUnit::g ? "g" : "m/s2", describe(stillness),
                             stillness.gravity_confirms_bias ? ", a bias by gravity's witness" : "");
  return std::optional(start);
}

}  // namespace pllit
