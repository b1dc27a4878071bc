#include "pllit/sim/box_scene.hpp"

#include <utility>

namespace pllit {
namespace {

/// The noise densities, 0.014 deg/s/sqrt(Hz) and 190 ug/sqrt(Hz), are of the order that makers of small MEMS IMUs
/// state; the walks and ranges are assumed.
Rig handheld_rig() {
  Rig rig;
  rig.T_I_L = pose_from(exp_so3({0.01, -0.02, 0.5}), {0.04, -0.02, 0.11});
  rig.lidar = {.min_range_m = 0.5, .max_range_m = 120.0, .range_sigma_m = 0.01, .beam_sigma_rad = 0.0005};
  rig.imu = {.gyro_density = 0.00024,
             .accel_density = 0.0019,
             .gyro_bias_walk = 1e-5,
             .accel_bias_walk = 1e-4,
             .gyro_bias_sigma = 0.01,
             .accel_bias_sigma = 0.05};
  return rig;
}

ImuNoise no_noise() {
  return {.gyro_density = 0.0,
          .accel_density = 0.0,
          .gyro_bias_walk = 0.0,
          .accel_bias_walk = 0.0,
          .gyro_bias_sigma = 0.0,
          .accel_bias_sigma = 0.0};
}

Scene scene_of(const SimConfig& config, double duration_s) {
  if (config.scene == SceneKind::box_corridor) return corridor(1.5 * config.speed_mps * duration_s);
  return config.scene == SceneKind::box_room ? room(config.seed) : outdoor(config.seed);
}

Motion motion_of(const SimConfig& config, const Lane& lane, double duration_s) {
  const MotionConfig motion{.seed = config.seed, .duration_s = duration_s, .speed_mps = config.speed_mps};
  return config.carried == SimConfig::Carried::walk ? walk_along(lane, motion) : fast_shake(lane, motion);
}

}  // namespace

BoxScene box_scene(const SimConfig& config) {
  const double duration_s = config.duration_s.value_or(30.0);
  Scene scene = scene_of(config, duration_s);
  const Rig rig = handheld_rig();
  const ImuModel imu{.noise = config.ideal ? no_noise() : rig.imu, .rate_hz = config.imu_rate_hz};
  SpinningLidar lidar{.pattern = config.box_lidar == SimConfig::BoxLidar::ring32 ? ring32_pattern() : ring16_pattern(),
                      .model = rig.lidar,
                      .T_I_L = rig.T_I_L};
  if (config.ideal) lidar.model.range_sigma_m = lidar.model.beam_sigma_rad = 0.0;
  return {std::move(scene.world), motion_of(config, scene.lane, duration_s), rig, imu, lidar};
}

}  // namespace pllit
