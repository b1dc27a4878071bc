#include "pllit/slam/config.hpp"

#include <format>
#include <numbers>

namespace pllit {
namespace {

SE3 pose_of(const PoseConfig& config) {
  const auto& [x, y, z, w] = config.rotation_xyzw;
  return pose_from(rotation_from(Eigen::Quaterniond(w, x, y, z)), Vector3d(config.translation_m.data()));
}

Camera camera_of(const RigConfig::Camera& config) {
  const auto& [width, height] = config.size_px;
  const auto& [fx, fy, cx, cy] = config.intrinsics_px;
  return {.width = width,
          .height = height,
          .fx = fx,
          .fy = fy,
          .cx = cx,
          .cy = cy,
          .distortion = config.model,
          .k = config.distortion};
}

}  // namespace

Expected<void> check(const Config& config) {
  const auto& [min_range_m, max_range_m] = config.rig.lidar.range_m;
  if (min_range_m >= max_range_m)
    return input_error(std::format("rig.lidar.range_m: [{}, {}] keeps no point; give [nearest, farthest] in metres",
                                   min_range_m, max_range_m));
  const RigConfig::Camera& camera = config.rig.camera;
  const auto& [width, height] = camera.size_px;
  const auto& [fx, fy, cx, cy] = camera.intrinsics_px;
  if ((width == 0) != (height == 0))
    return input_error(std::format(
        "rig.camera.size_px: [{}, {}] is no image; give [width, height], or [0, 0] for a rig without camera", width,
        height));
  if (width > 0 && (fx <= 0.0 || fy <= 0.0))
    return input_error(
        std::format("rig.camera.intrinsics_px: the focal lengths {} and {} are not positive; give [fx, fy, cx, cy] for "
                    "the size {}x{}",
                    fx, fy, width, height));
  if (width > 0 && (cx < 0.0 || cy < 0.0 || cx > width || cy > height))
    return input_error(std::format(
        "rig.camera.intrinsics_px: the centre ({}, {}) lies outside the {}x{} image; the order is [fx, fy, cx, cy]", cx,
        cy, width, height));
  const ThermographyConfig& heat = config.thermography;
  if (heat.unit_choice != UnitChoice::kelvin && heat.radiometry.corrects())
    return input_error(
        "advanced.radiometry corrects temperatures, but advanced.anomalies.unit is not kelvin; set emissivity to 1 and "
        "absorbed_per_m to 0, or the unit to kelvin where the camera is radiometric");
  return {};
}

Rig make_rig(const RigConfig& config) {
  Rig rig;
  rig.T_I_L = pose_of(config.lidar.T_I_L);
  rig.T_I_C = pose_of(config.camera.T_I_C);
  rig.lidar = {.min_range_m = config.lidar.range_m[0],
               .max_range_m = config.lidar.range_m[1],
               .range_sigma_m = config.lidar.range_sigma_m,
               .beam_sigma_rad = config.lidar.beam_sigma_deg * std::numbers::pi / 180.0};
  rig.imu = {.gyro_density = config.imu.noise_density[0],
             .accel_density = config.imu.noise_density[1],
             .gyro_bias_walk = config.imu.bias_walk[0],
             .accel_bias_walk = config.imu.bias_walk[1],
             .gyro_bias_sigma = config.imu.bias_sigma[0],
             .accel_bias_sigma = config.imu.bias_sigma[1]};
  if (config.camera.size_px[0] > 0) rig.camera = camera_of(config.camera);
  rig.lidar_delay = from_seconds(config.lidar.delay_s);
  rig.camera_delay = from_seconds(config.camera.delay_s);
  return rig;
}

}  // namespace pllit
