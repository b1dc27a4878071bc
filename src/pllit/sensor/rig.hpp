// The rig: the only place with extrinsics, intrinsics, sensor noise and delays.
#pragma once

#include <optional>

#include "pllit/base/time.hpp"
#include "pllit/geometry/camera.hpp"
#include "pllit/geometry/lie.hpp"

namespace pllit {

/// IMU noise as data sheets give it: continuous densities, so that they hold at any sample rate.
struct ImuNoise {
  double gyro_density = 0.003;     ///< rad/s/sqrt(Hz)
  double accel_density = 0.02;     ///< m/s2/sqrt(Hz)
  double gyro_bias_walk = 3e-5;    ///< rad/s2/sqrt(Hz)
  double accel_bias_walk = 3e-4;   ///< m/s3/sqrt(Hz)
  double gyro_bias_sigma = 0.01;   ///< rad/s, how far the bias may be from zero when switched on
  double accel_bias_sigma = 0.10;  ///< m/s2, likewise
};

/// LiDAR measurement noise and the ranges that are kept.
struct LidarModel {
  double min_range_m = 0.7;
  double max_range_m = 120.0;
  double range_sigma_m = 0.02;    ///< along the ray
  double beam_sigma_rad = 0.001;  ///< across the ray
};

/// T_I_X maps coordinates in X to the IMU frame I. A delay is added to the sensor's stamps to get IMU time.
struct Rig {
  SE3 T_I_L = SE3::Identity();
  SE3 T_I_C = SE3::Identity();
  LidarModel lidar;
  ImuNoise imu;
  std::optional<Camera> camera;
  Duration lidar_delay{0};
  Duration camera_delay{0};
};

}  // namespace pllit
