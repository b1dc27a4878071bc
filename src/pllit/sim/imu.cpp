#include "pllit/sim/imu.hpp"

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

}  // namespace

ImuSample exact_imu(const MotionState& state, Time time) {
  const Vector3d specific_force_W = state.a_W + Vector3d(0.0, 0.0, kStandardGravity_mps2);
  return {time, state.omega_I, state.T_W_I.asSO3().inverse().act(specific_force_W)};
}

ImuStream::ImuStream(Time start, double rate_hz, const ImuNoise& noise, std::uint64_t seed,
                     const std::optional<ImuBias>& first_bias)
    : start_(start), rate_hz_(rate_hz), noise_(noise), bias_random_(seed, 20), white_random_(seed, 21) {
  assert(rate_hz >= 10.0 && rate_hz <= 1000.0);
  bias_ = first_bias ? *first_bias : scattered({}, noise.gyro_bias_sigma, noise.accel_bias_sigma, bias_random_);
}

Time ImuStream::next_time() const { return start_ + from_seconds(static_cast<double>(index_) / rate_hz_); }

ImuSample ImuStream::next(const Motion& motion) {
  const double root_rate = std::sqrt(rate_hz_);
  ImuSample sample = exact_imu(motion.at(next_time()), next_time());
  sample.gyro_rps += bias_.gyro_rps + noise_.gyro_density * root_rate * white_random_.gaussian3();
  sample.accel_mps2 += bias_.accel_mps2 + noise_.accel_density * root_rate * white_random_.gaussian3();
  bias_ = scattered(bias_, noise_.gyro_bias_walk / root_rate, noise_.accel_bias_walk / root_rate, bias_random_);
  ++index_;
  return sample;
}

}  // namespace pllit
