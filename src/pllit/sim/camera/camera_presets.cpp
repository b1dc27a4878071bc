#include "pllit/sim/camera/camera_presets.hpp"

#include <Eigen/Geometry>

namespace pllit {

ThermalCameraModel botu_tb640() {
  ThermalCameraModel model;
  model.camera = {.width = 640,
                  .height = 512,
                  .fx = 735.0,
                  .fy = 735.0,
                  .cx = 322.4,
                  .cy = 254.1,
                  .k = {-0.28, 0.09, 0.0004, -0.0003, 0.0}};
  model.rate_hz = 25.0;
  model.netd_K = 0.05;
  return model;
}

ThermalCameraModel boson_640() {
  ThermalCameraModel model;
  model.camera = {.width = 640,
                  .height = 512,
                  .fx = 725.0,
                  .fy = 725.0,
                  .cx = 317.8,
                  .cy = 257.3,
                  .k = {-0.26, 0.07, 0.0, 0.0, 0.0}};
  model.rate_hz = 30.0;
  model.time_constant_s = 0.008;
  model.netd_K = 0.04;
  model.agc.speed_256 = 24;
  return model;
}

ThermalCameraModel ntu4dradlm_thermal() {
  ThermalCameraModel model;
  model.camera = {.width = 640, .height = 480, .fx = 457.2, .fy = 457.9, .cx = 323.1, .cy = 242.5};
  model.rate_hz = 20.0;
  model.netd_K = 0.05;
  return model;
}

VisibleCameraModel hilti2022_cam0() {
  VisibleCameraModel model;
  model.camera = {.width = 720,
                  .height = 540,
                  .fx = 351.314,
                  .fy = 351.491,
                  .cx = 367.852,
                  .cy = 253.840,
                  .distortion = Camera::Distortion::equidistant,
                  .k = {-0.036967, -0.008918, 0.008913, -0.003769, 0.0}};
  return model;
}

SE3 hilti2022_T_I_lidar() {
  Matrix3d R_I_L;
  R_I_L << 0.0, -1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
  return pose_from(rotation_from(Eigen::Quaterniond(R_I_L)), {-0.001, -0.00855, 0.055});
}

SE3 hilti2022_T_I_cam0() {
  Matrix3d R_C_L;
  R_C_L << -0.999926, -0.00670802, 0.0101073, -0.0100912, -0.00242564, -0.999946, 0.00673218, -0.999975, 0.00235777;
  const SE3 T_C_L = pose_from(rotation_from(Eigen::Quaterniond(R_C_L)), {-0.0549762, 0.0675401, -0.0520599});
  return hilti2022_T_I_lidar() * T_C_L.inverse();
}

}  // namespace pllit
