#include "pllit/sim/rigs.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

ImuModel known_imu(std::string_view name) {
  auto model = imu_model(name);
  assert(model);
  return std::move(*model);
}

/// A camera that looks along x of a frame with z up: x to the right, y down, z forward.
Matrix3d looking_ahead() {
  Matrix3d R;
  R << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return R;
}

/// The organisers' IMU <- LiDAR of Hilti-Oxford 2022. The Alphasense holds a BMI085.
SimRig hilti2022() {
  SimRig rig{.name = "hilti2022",
             .imu = known_imu("bmi085"),
             .lidar = pandar_xt32(),
             .thermal = {},
             .visible = hilti2022_cam0()};
  rig.T_I_L = hilti2022_T_I_lidar();
  rig.T_I_C = hilti2022_T_I_cam0();
  rig.told_noise.gyro_density = 0.005;
  rig.told_noise.accel_density = 0.019;
  rig.told_noise.gyro_bias_walk = 2.66e-4;
  rig.told_noise.accel_bias_walk = 4.3e-3;
  // I has z down; its x axis is where the camera looks.
  rig.R_B_I = exp_so3({std::numbers::pi, 0.0, 0.0});
  return rig;
}

/// The Horizon's factory lever arm to its BMI088; the camera as
/// composed from 4DRadarSLAM's calibration (nearest rotation).
SimRig ntu4dradlm() {
  SimRig rig{.name = "ntu4dradlm",
             .imu = known_imu("bmi088"),
             .lidar = livox_horizon(),
             .thermal = ntu4dradlm_thermal(),
             .visible = {}};
  rig.height_m = 1.7;
  rig.on_car = true;
  rig.accel_in_g = true;
  rig.told_noise.gyro_density = 0.007;
  rig.told_noise.accel_density = 0.022;
  rig.T_I_L = pose_from(SO3::Identity(), {0.05512, 0.02226, -0.0297});
  rig.T_I_C =
      pose_from(rotation_from(Eigen::Quaterniond(0.494781267106, -0.503658973323, 0.498796360175, -0.502713961799)),
                {0.325100658, -0.131400486, 0.061929141});
  return rig;
}

/// Assumed: the camera 6 cm before and 5 cm under the LiDAR, the IMU below both.
SimRig inspection() {
  SimRig rig{
      .name = "inspection", .imu = known_imu("hi71"), .lidar = livox_mid360(), .thermal = botu_tb640(), .visible = {}};
  // Level, it would see nothing of the lower half of what the camera sees.
  constexpr double tilt = 25.0 * std::numbers::pi / 180.0;
  rig.T_I_L = pose_from(exp_so3({0.0, tilt, 0.0}), {0.02, 0.0, 0.12});
  rig.T_I_C = pose_from(rotation_from(Eigen::Quaterniond(looking_ahead())), {0.08, 0.0, 0.07});
  return rig;
}

Vector3d random_direction(Random& random) { return random.gaussian3().normalized(); }

}  // namespace

Rig SimRig::known() const {
  Rig rig;
  rig.T_I_L = T_I_L;
  rig.T_I_C = T_I_C;
  rig.lidar = {.min_range_m = lidar.min_range_m,
               .max_range_m = lidar.max_range_m,
               .range_sigma_m = lidar.range_sigma_m,
               .beam_sigma_rad = lidar.beam_sigma_rad};
  rig.imu = told_noise;
  rig.camera = camera();
  // A bolometer shows the scene of one time constant ago.
  if (thermal) rig.camera_delay = -from_seconds(thermal->time_constant_s);
  return rig;
}

SimRig sim_rig(SimConfig::RigName name) {
  switch (name) {
    case SimConfig::RigName::hilti2022:
      return hilti2022();
    case SimConfig::RigName::ntu4dradlm:
      return ntu4dradlm();
    case SimConfig::RigName::inspection:
      return inspection();
  }
  return inspection();
}

SimRig as_built(SimRig rig, std::uint64_t seed) {
  Random random(seed, 40);
  constexpr double deg = std::numbers::pi / 180.0;
  const Vector3d turn = random.uniform(0.1, 0.3) * deg * random_direction(random);
  const Vector3d shift_m = random.uniform(0.005, 0.015) * random_direction(random);
  rig.T_I_C = rig.T_I_C * pose_from(exp_so3(turn), shift_m);
  const double stretch = 1.0 + random.uniform(-0.003, 0.003);
  for (Camera* camera : {rig.thermal ? &rig.thermal->camera : nullptr, rig.visible ? &rig.visible->camera : nullptr})
    if (camera) {
      camera->fx *= stretch;
      camera->fy *= stretch;
    }
  rig.lidar_clock = from_seconds(random.uniform(-0.005, 0.005));
  rig.camera_clock = from_seconds(random.uniform(-0.005, 0.005));
  for (double* figure : {&rig.imu.noise.gyro_density, &rig.imu.noise.accel_density, &rig.imu.noise.gyro_bias_walk,
                         &rig.imu.noise.accel_bias_walk})
    *figure *= std::exp2(random.uniform(-1.0, 1.0));
  rig.lidar.unit = drawn_unit(rig.lidar.tolerance, lines_of(rig.lidar.pattern), random);
  return rig;
}

SimRig without_errors(SimRig rig) {
  rig.imu = {.noise = {.gyro_density = 0.0,
                       .accel_density = 0.0,
                       .gyro_bias_walk = 0.0,
                       .accel_bias_walk = 0.0,
                       .gyro_bias_sigma = 0.0,
                       .accel_bias_sigma = 0.0},
             .rate_hz = rig.imu.rate_hz};
  rig.lidar = without_errors(rig.lidar);
  return rig;
}

}  // namespace pllit
