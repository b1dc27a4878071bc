// What an IMU on the moving rig would read: exact values, noise and biases.
#pragma once

#include <cstdint>
#include <optional>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sensor/rig.hpp"
#include "pllit/sim/motion.hpp"
#include "pllit/sim/random.hpp"

namespace pllit {

inline constexpr double kStandardGravity_mps2 = 9.80665;

struct ImuBias {
  Vector3d gyro_rps = Vector3d::Zero();
  Vector3d accel_mps2 = Vector3d::Zero();
};

struct StampedImuBias {
  Time time;
  ImuBias bias;
};

/// Angular rate and specific force R^T (a - g) at one instant, without noise or bias. The value is instantaneous, not
/// an average over the sample interval.
ImuSample exact_imu(const MotionState& state, Time time);

/// Samples of one IMU in time order, from the start of a motion on. White noise of continuous density d has the
/// standard deviation d sqrt(rate) in each sample; biases walk by a normal step of walk / sqrt(rate) from sample to
/// sample.
class ImuStream {
 public:
  /// rate_hz is 10 to 1000. The first bias is drawn from the noise's bias sigmas where it is not given.
  ImuStream(Time start, double rate_hz, const ImuNoise& noise, std::uint64_t seed,
            const std::optional<ImuBias>& first_bias = std::nullopt);

  /// Time of the sample that next() will give.
  Time next_time() const;
  ImuSample next(const Motion& motion);
  /// The true bias in the sample that next() will give.
  const ImuBias& bias() const { return bias_; }

 private:
  Time start_;
  double rate_hz_;
  ImuNoise noise_;
  Random bias_random_, white_random_;
  ImuBias bias_;
  std::int64_t index_ = 0;
};

}  // namespace pllit
