#include <gtest/gtest.h>

#include <numbers>

#include "pllit/slam/config.hpp"

namespace pllit {
namespace {

TEST(RigFromConfig, KeepsTheDefaultsOfTheSensors) {
  const Rig rig = make_rig(RigConfig{});
  EXPECT_EQ(rig.imu.gyro_density, ImuNoise{}.gyro_density);
  EXPECT_EQ(rig.imu.accel_bias_sigma, ImuNoise{}.accel_bias_sigma);
  EXPECT_EQ(rig.lidar.max_range_m, LidarModel{}.max_range_m);
  EXPECT_NEAR(rig.lidar.beam_sigma_rad, LidarModel{}.beam_sigma_rad, 1e-4);
  EXPECT_FALSE(rig.camera);
  EXPECT_EQ(rig.T_I_L.coeffs(), SE3::Identity().coeffs());
}

TEST(RigFromConfig, ConvertsToSiUnits) {
  RigConfig config;
  config.lidar.beam_sigma_deg = 0.5;
  config.lidar.delay_s = -0.1;
  config.camera.delay_s = 0.0125;
  config.imu.bias_walk = {1e-6, 2e-4};
  const Rig rig = make_rig(config);
  EXPECT_DOUBLE_EQ(rig.lidar.beam_sigma_rad, 0.5 * std::numbers::pi / 180.0);
  EXPECT_EQ(rig.lidar_delay, std::chrono::milliseconds(-100));
  EXPECT_EQ(rig.camera_delay, std::chrono::microseconds(12500));
  EXPECT_EQ(rig.imu.gyro_bias_walk, 1e-6);
  EXPECT_EQ(rig.imu.accel_bias_walk, 2e-4);
}

TEST(RigFromConfig, ReadsQuaternionsAsXyzwFromChildToParent) {
  RigConfig config;
  const double half = std::numbers::sqrt2 / 2.0;
  config.lidar.T_I_L = {.translation_m = {1.0, 2.0, 3.0},
                        .rotation_xyzw = {0.0, 0.0, half, half}};  // a quarter turn about z
  const Vector3d p_I = make_rig(config).T_I_L.act(Vector3d(1.0, 0.0, 0.0));
  EXPECT_NEAR((p_I - Vector3d(1.0, 3.0, 3.0)).norm(), 0.0, 1e-12);
}

TEST(RigFromConfig, NormalisesRoundedQuaternions) {
  RigConfig config;
  config.camera.T_I_C.rotation_xyzw = {0.7071, 0.0, 0.0, 0.7071};
  EXPECT_NEAR(make_rig(config).T_I_C.rotation().determinant(), 1.0, 1e-12);
}

TEST(RigFromConfig, HandsOverTheCamera) {
  RigConfig config;
  config.camera.size_px = {640, 512};
  config.camera.intrinsics_px = {500.0, 501.0, 320.0, 256.0};
  config.camera.model = Camera::Distortion::equidistant;
  config.camera.distortion = {0.1, 0.2, 0.3, 0.4, 0.0};
  const auto camera = make_rig(config).camera;
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->width, 640);
  EXPECT_EQ(camera->height, 512);
  EXPECT_EQ(camera->fx, 500.0);
  EXPECT_EQ(camera->fy, 501.0);
  EXPECT_EQ(camera->cx, 320.0);
  EXPECT_EQ(camera->cy, 256.0);
  EXPECT_EQ(camera->distortion, Camera::Distortion::equidistant);
  EXPECT_EQ(camera->k, config.camera.distortion);
}

}  // namespace
}  // namespace pllit
