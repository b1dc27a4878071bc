// What shakes a rig beyond its path: steps, the road, an engine.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pllit/geometry/lie.hpp"

namespace pllit {

/// Sines of random frequency and phase, evenly spread over the logarithm of frequency, on every axis.
struct VibrationBand {
  double low_hz = 5.0;
  double high_hz = 80.0;
  double acceleration_mps2 = 0.0;  ///< rms on each axis of W at full strength
  double angular_rate_rps = 0.0;   ///< rms on each axis of I at full strength
};

/// Strength grows with speed as v / sqrt(v^2 + full_speed^2): in proportion at first, to 1 at last, 0 at rest.
struct VibrationConfig {
  std::uint64_t seed = 1;
  double full_speed_mps = 1.0;
  std::vector<VibrationBand> bands;
};

/// Steps and trembling hands: assumed figures, of the size seen in hand-held recordings.
VibrationConfig hand_held_vibration(std::uint64_t seed);
/// Road (5 to 25 Hz) and engine (25 to 80 Hz) as felt on a car's roof: assumed figures.
VibrationConfig vehicle_vibration(std::uint64_t seed);

/// A displacement added in W and a small rotation made after the path's own, with their exact derivatives.
struct VibrationState {
  Vector3d offset_W = Vector3d::Zero();  ///< m
  Vector3d offset_rate_W = Vector3d::Zero();
  Vector3d offset_acceleration_W = Vector3d::Zero();
  Vector3d angle_I = Vector3d::Zero();  ///< rotation vector, rad
  Vector3d angle_rate_I = Vector3d::Zero();
};

class Vibration {
 public:
  /// speeds_mps, at least one, are taken `spacing_s` apart from time 0 on. Strength follows them late by up to six
  /// spacings, never early: it is exactly zero until the first speed above zero.
  Vibration(const VibrationConfig& config, double spacing_s, const std::vector<double>& speeds_mps);

  VibrationState at(double t_s) const;

 private:
  struct Wave {
    double amplitude, omega_rps, phase;
  };
  struct Strength {
    double value, rate, acceleration;
  };
  Strength strength_at(double t_s) const;

  double spacing_s_;
  std::vector<double> strengths_;           // controls of a quintic B-spline
  std::array<std::vector<Wave>, 6> waves_;  // offset x y z, angle x y z
};

}  // namespace pllit
