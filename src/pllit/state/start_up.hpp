// Start-up: what can be known of attitude, gravity and biases before the first scan is matched.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "pllit/base/error.hpp"
#include "pllit/sensor/measurements.hpp"
#include "pllit/sensor/rig.hpp"
#include "pllit/state/nav_state.hpp"

namespace pllit {

enum class AccelUnit { automatic, mps2, g };
enum class StartMode { automatic, still, moving };

struct StartUpConfig {
  StartMode mode = StartMode::automatic;
  AccelUnit unit = AccelUnit::automatic;
  double window_s = 1.0;                 ///< length of IMU data that is looked at
  double gravity_mps2 = 9.81;            ///< local gravity
  double gravity_sigma_mps2 = 0.02;      ///< how well it is known (9.78 to 9.83 on Earth)
  double still_gyro_spread_rps = 0.03;   ///< at rest every axis varies less (standard deviation), engine included
  double still_accel_spread_mps2 = 0.2;  ///< likewise
  double still_slow_spread_rps = 0.004;  ///< likewise for means over a tenth of the window: a hand moves slowly
  double still_rate_rps = 0.008;         ///< a mean rate above this is motion, unless gravity confirms it as a bias
  double moving_accel_mps2 = 1.0;        ///< mean acceleration that a moving start may have (one sigma)
  double moving_speed_mps = 10.0;        ///< speed that a moving start may have (one sigma)
};

/// How still a stretch of IMU data is.
struct Stillness {
  bool still = false;
  Vector3d mean_rate_rps, mean_accel_mps2;
  double gyro_spread_rps = 0.0, accel_spread_mps2 = 0.0;  ///< largest standard deviation of an axis
  double slow_spread_rps = 0.0;                           ///< likewise, of the means over tenths of the stretch
  bool quiet = false;                                     ///< small spread: at rest, or turning very evenly
  bool gravity_confirms_bias = false;  ///< a mean rate that the direction of gravity does not follow is a bias
};
/// The state at the first sample's time, with what is known of it. W has z up and its x axis along the IMU's; position
/// and attitude are exact by definition (they define W), so the doubt about the vertical stands with gravity and the
/// accelerometer bias, jointly.
struct Start {
  Estimate estimate;
  bool still = false;
  Stillness stillness;
  AccelUnit unit = AccelUnit::mps2;
  std::string report;  ///< one line for people
};

/// Unit of the accelerometer from the mean length of its vectors (0.8-1.2: g; 8-11.5: m/s2), or why it cannot be told.
Expected<AccelUnit> accel_unit_of(std::span<const ImuSample> imu, AccelUnit configured);
/// Factor that turns the unit into m/s2.
double mps2_per(AccelUnit unit);

/// `imu` in m/s2 and rad/s. Still means small spread and small mean rate, or a rate that gravity shows to be a bias:
/// about the vertical gravity shows nothing, so there only a small rate will do.
Stillness measure_stillness(std::span<const ImuSample> imu, const StartUpConfig& config);

/// The start from IMU data as recorded; nothing while more data is needed; an error where no start is possible (unit
/// unknown, or not still though configured to be).
Expected<std::optional<Start>> start_up(std::span<const ImuSample> imu, const ImuNoise& noise,
                                        const StartUpConfig& config);

}  // namespace pllit
