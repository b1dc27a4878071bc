// What an IMU on the moving rig would read: exact values, noise and biases.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sensor/rig.hpp"
#include "pllit/sim/motion/motion.hpp"
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

/// Everything between the truth and the samples. The defaults are an IMU with noise and biases alone.
struct ImuModel {
  ImuNoise noise{};
  double rate_hz = 200.0;
  double gyro_scale_sigma = 0.0;        ///< of each axis, relative
  double accel_scale_sigma = 0.0;       ///< likewise
  double misalignment_sigma_rad = 0.0;  ///< of each axis towards each other one, gyroscope and accelerometer alike
  double gyro_lsb_rps = 0.0;            ///< one count; 0 where samples are not rounded
  double accel_lsb_mps2 = 0.0;
  double gyro_range_rps = std::numeric_limits<double>::infinity();  ///< samples saturate at +- this
  double accel_range_mps2 = std::numeric_limits<double>::infinity();
};

/// Angular rate and specific force R^T (a - g) at one instant, without noise or bias. The value is instantaneous, not
/// an average over the sample interval.
ImuSample exact_imu(const MotionState& state, Time time);

/// When sample `index` is taken.
Time imu_time(Time start, double rate_hz, std::int64_t index);

/// Samples of one IMU in time order, from the start of a motion on: truth times scale and misalignment, plus bias and
/// noise, then saturated, then rounded to whole counts. White noise of continuous density d has the standard deviation
/// d sqrt(rate) in each sample; biases walk by a normal step of walk / sqrt(rate) from sample to sample.
class ImuStream {
 public:
  /// The rate is 10 to 4000 Hz. Scales and misalignments are drawn from their sigmas, as is the first bias where it is
  /// not given.
  ImuStream(Time start, const ImuModel& model, std::uint64_t seed,
            const std::optional<ImuBias>& first_bias = std::nullopt);
  ImuStream(Time start, double rate_hz, const ImuNoise& noise, std::uint64_t seed,
            const std::optional<ImuBias>& first_bias = std::nullopt)
      : ImuStream(start, ImuModel{.noise = noise, .rate_hz = rate_hz}, seed, first_bias) {}

  /// Time of the sample that next() will give.
  Time next_time() const;
  ImuSample next(const Motion& motion);
  /// The true bias in the sample that next() will give.
  const ImuBias& bias() const { return bias_; }
  /// What the truth is multiplied by: 1 plus scale errors on the diagonal, misalignments beside it.
  const Matrix3d& gyro_distortion() const { return gyro_distortion_; }
  const Matrix3d& accel_distortion() const { return accel_distortion_; }

 private:
  Time start_;
  ImuModel model_;
  Random bias_random_, white_random_;
  ImuBias bias_;
  Matrix3d gyro_distortion_, accel_distortion_;
  std::int64_t index_ = 0;
};

}  // namespace pllit
