#include "pllit/sim/motion/imu.hpp"

#include <cassert>
#include <cmath>

namespace pllit {
namespace {

/// `mean` with independent normal deviations of `sigma` in the two parts.
ImuBias scattered(const ImuBias& mean, double gyro_sigma, double accel_sigma, Random& random) {
  ImuBias bias = mean;
  bias.gyro_rps += gyro_sigma * random.gaussian3();
  bias.accel_mps2 += accel_sigma * random.gaussian3();
  return bias;
}

Matrix3d distortion(double scale_sigma, double misalignment_sigma_rad, Random& random) {
  Matrix3d matrix = Matrix3d::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      matrix(row, column) += (row == column ? scale_sigma : misalignment_sigma_rad) * random.gaussian();
  return matrix;
}

/// Held within +-range, then rounded to whole counts of lsb, none where lsb is 0.
Vector3d read_out(const Vector3d& value, double lsb, double range) {
  const Vector3d held = value.cwiseMax(-range).cwiseMin(range);
  return lsb > 0.0 ? Vector3d((held / lsb).array().round() * lsb) : held;
}

}  // namespace

ImuSample exact_imu(const MotionState& state, Time time) {
  const Vector3d specific_force_W = state.a_W + Vector3d(0.0, 0.0, kStandardGravity_mps2);
  return {time, state.omega_I, state.T_W_I.asSO3().inverse().act(specific_force_W)};
}

Time imu_time(Time start, double rate_hz, std::int64_t index) {
  return start + from_seconds(static_cast<double>(index) / rate_hz);
}

ImuStream::ImuStream(Time start, const ImuModel& model, std::uint64_t seed, const std::optional<ImuBias>& first_bias)
    : start_(start), model_(model), bias_random_(seed, 20), white_random_(seed, 21) {
  assert(model.rate_hz >= 10.0 && model.rate_hz <= 4000.0);
  const ImuNoise& noise = model.noise;
  bias_ = first_bias ? *first_bias : scattered({}, noise.gyro_bias_sigma, noise.accel_bias_sigma, bias_random_);
  Random distortion_random(seed, 22);
  gyro_distortion_ = distortion(model.gyro_scale_sigma, model.misalignment_sigma_rad, distortion_random);
  accel_distortion_ = distortion(model.accel_scale_sigma, model.misalignment_sigma_rad, distortion_random);
}

Time ImuStream::next_time() const { return imu_time(start_, model_.rate_hz, index_); }

ImuSample ImuStream::next(const Motion& motion) {
  const double root_rate = std::sqrt(model_.rate_hz);
  const ImuNoise& noise = model_.noise;
  ImuSample sample = exact_imu(motion.at(next_time()), next_time());
  sample.gyro_rps = gyro_distortion_ * sample.gyro_rps + bias_.gyro_rps;
  sample.accel_mps2 = accel_distortion_ * sample.accel_mps2 + bias_.accel_mps2;
  sample.gyro_rps += noise.gyro_density * root_rate * white_random_.gaussian3();
  sample.accel_mps2 += noise.accel_density * root_rate * white_random_.gaussian3();
  sample.gyro_rps = read_out(sample.gyro_rps, model_.gyro_lsb_rps, model_.gyro_range_rps);
  sample.accel_mps2 = read_out(sample.accel_mps2, model_.accel_lsb_mps2, model_.accel_range_mps2);
  bias_ = scattered(bias_, noise.gyro_bias_walk / root_rate, noise.accel_bias_walk / root_rate, bias_random_);
  ++index_;
  return sample;
}

}  // namespace pllit
