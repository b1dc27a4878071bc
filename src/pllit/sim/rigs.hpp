// Rigs to simulate: what their estimator is told, and how they differ from that.
#pragma once

#include <optional>
#include <string>

#include "pllit/sensor/rig.hpp"
#include "pllit/sim/camera/camera_presets.hpp"
#include "pllit/sim/config.hpp"
#include "pllit/sim/motion/imu_models.hpp"
#include "pllit/sim/world/lidar_models.hpp"

namespace pllit {

/// Sensors and how they are mounted. Carried upright the rig looks along x of B, z of B up; T_I_* as in Rig.
struct SimRig {
  std::string name;
  SO3 R_B_I = SO3::Identity();
  double height_m = 1.3;  ///< of I above the ground
  bool on_car = false;
  bool accel_in_g = false;  ///< as Livox's drivers publish it
  ImuModel imu;
  /// What estimators of such rigs are configured with (config/*.yaml): more than the data sheet's noise, because it
  /// also has to cover vibration, scale and timing.
  ImuNoise told_noise{};
  RayLidar lidar;
  SE3 T_I_L = SE3::Identity(), T_I_C = SE3::Identity();
  std::optional<ThermalCameraModel> thermal;
  std::optional<VisibleCameraModel> visible;
  Duration lidar_clock{0}, camera_clock{0};  ///< what the sensor's stamps are late by against the IMU's

  /// Nothing on a rig without a camera.
  std::optional<Camera> camera() const {
    return thermal ? std::optional(thermal->camera) : visible ? std::optional(visible->camera) : std::nullopt;
  }
  /// What an estimator is told: the same for every seed.
  Rig known() const;
};

/// hilti2022: PandarXT-32, Alphasense IMU (z down) and its fisheye cam0, in the hands. ntu4dradlm: Livox Horizon with
/// its own IMU and a thermal camera, on a car. inspection: Livox Mid-360, HI71 and a thermal camera of the TB640's
/// class, in the hands.
SimRig sim_rig(SimConfig::RigName name);

/// The rig as it was really built, unlike its data sheet: the camera is turned by 0.1
/// to 0.3 degrees and moved by 5 to 15 mm, its focal length is wrong by up to 0.3 %,
/// the clocks by up to 5 ms, the IMU's noise is half to twice what was promised, and the LiDAR is one unit of its
/// model.
SimRig as_built(SimRig rig, std::uint64_t seed);
/// The rig without noise and bias.
SimRig without_errors(SimRig rig);

}  // namespace pllit
