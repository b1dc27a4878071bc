#include "pllit/slam/config_presets.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "config_support.hpp"

namespace pllit {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

Rig rig_of(const std::string& preset) {
  const auto config = find_config(preset);
  EXPECT_TRUE(config) << config.error().message;
  return make_rig(config.value_or(Config{}).rig);
}

/// A published calibration, p_B = R p_A + t with rounded digits.
struct Published {
  Matrix3d R;
  Vector3d t;
  Vector3d apply(const Vector3d& p) const { return R * p + t; }
};

Matrix3d matrix(const std::array<double, 9>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
}

TEST(Presets, AreTheFilesOfTheConfigFolder) {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) names.emplace_back(preset.name);
  EXPECT_THAT(names, testing::ElementsAre("default", "hilti2022", "inspection", "kitti", "ntu4dradlm"));
}

TEST(Presets, LoadAndSayWhatTheyAreFor) {
  for (const Preset& preset : presets()) {
    const auto config = find_config(std::string(preset.name));
    EXPECT_TRUE(config) << config.error().message;
    EXPECT_THAT(summary_of(preset), Not(IsEmpty())) << preset.name;
    EXPECT_THAT(summary_of(preset), Not(testing::StartsWith("#"))) << preset.name;
  }
}

TEST(Presets, HoldProperRotationsToTheLastDigitGiven) {
  for (const Preset& preset : presets()) {
    const auto config = find_config(std::string(preset.name));
    ASSERT_TRUE(config) << config.error().message;
    for (const PoseConfig& pose : {config->rig.lidar.T_I_L, config->rig.camera.T_I_C}) {
      EXPECT_NEAR(Eigen::Map<const Eigen::Vector4d>(pose.rotation_xyzw.data()).norm(), 1.0, 1e-10) << preset.name;
    }
    EXPECT_NEAR(make_rig(config->rig).T_I_L.rotation().determinant(), 1.0, 1e-12);
  }
}

TEST(KittiPreset, InvertsThePublishedImuToVelodyneTransform) {
  const Published imu_to_velodyne{matrix({0.9999976, 0.0007553071, -0.002035826, -0.0007854027, 0.9998898, -0.01482298,
                                          0.002024406, 0.01482454, 0.9998881}),
                                  {-0.8086759, 0.3195559, -0.7997231}};
  const SE3 T_I_L = rig_of("kitti").T_I_L;
  for (const Vector3d& p_I :
       {Vector3d(0.0, 0.0, 0.0), Vector3d(1.0, 0.0, 0.0), Vector3d(0.0, 10.0, 0.0), Vector3d(5.0, -3.0, 2.0)})
    EXPECT_NEAR((T_I_L.act(imu_to_velodyne.apply(p_I)) - p_I).norm(), 0.0, 1e-6);
  EXPECT_GT(T_I_L.translation().z(), 0.5) << "the Velodyne sits on the roof, above the IMU";
}

/// The centre of the image must look where the LiDAR measures, with the published transform as the judge.
void expect_camera_sees(const Rig& rig, const Published& lidar_to_camera, const Vector3d& front_L) {
  ASSERT_TRUE(rig.camera);
  const SE3 T_C_L = rig.T_I_C.inverse().compose(rig.T_I_L);
  const Vector3d p_C = T_C_L.act(front_L);
  EXPECT_NEAR((p_C - lidar_to_camera.apply(front_L)).norm(), 0.0, 1e-4);
  EXPECT_GT(p_C.z(), 4.0);
  const auto pixel = rig.camera->project(p_C);
  ASSERT_TRUE(pixel);
  EXPECT_TRUE(pixel->x() > 0.0 && pixel->x() < rig.camera->width && pixel->y() > 0.0 && pixel->y() < rig.camera->height)
      << pixel->transpose();
  EXPECT_FALSE(rig.camera->project(T_C_L.act(-front_L))) << "what lies behind is not seen";
}

TEST(HiltiPreset, HasTheCameraLookWhereThePublishedCalibrationSays) {
  const Published lidar_to_cam0{matrix({-0.999926, -0.00670802, 0.0101073, -0.0100912, -0.00242564, -0.999946,
                                        0.00673218, -0.999975, 0.00235777}),
                                {-0.0549762, 0.0675401, -0.0520599}};
  const Rig rig = rig_of("hilti2022");
  expect_camera_sees(rig, lidar_to_cam0, Vector3d(0.2, -5.0, 0.3));
  EXPECT_GT((rig.T_I_C.rotation() * Vector3d::UnitZ()).x(), 0.99) << "cam0 looks along the IMU's x axis";
}

TEST(HiltiPreset, TurnsTheLidarUprightInTheImuFrameThatPointsDown) {
  const SE3 T_I_L = rig_of("hilti2022").T_I_L;
  const Matrix3d expected = matrix({0.0, -1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0});
  EXPECT_NEAR((T_I_L.rotation() - expected).norm(), 0.0, 1e-12);
  EXPECT_NEAR((T_I_L.translation() - Vector3d(-0.001, -0.00855, 0.055)).norm(), 0.0, 1e-12);
}

TEST(Ntu4dradlmPreset, HasTheCameraLookWhereTheLivoxDoes) {
  const Published lidar_to_thermal{
      matrix({-0.00304, -0.99991, 0.01280, -0.00498, -0.01279, -0.99991, 0.99998, -0.00310, -0.00494}),
      {-0.154, 0.091, -0.270}};
  const Rig rig = rig_of("ntu4dradlm");
  expect_camera_sees(rig, lidar_to_thermal, Vector3d(6.0, 0.2, 0.1));
  EXPECT_NEAR((rig.T_I_L.translation() - Vector3d(0.05512, 0.02226, -0.0297)).norm(), 0.0, 1e-12);
}

TEST(FindConfig, ReadsAFileWhereNoPresetHasTheName) {
  const auto path = std::filesystem::path(testing::TempDir()) / "pllit_find_config.yaml";
  std::ofstream(path) << "threads: 7\n";
  const auto config = find_config(path.string());
  std::filesystem::remove(path);
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->threads, 7);
}

TEST(FindConfig, ListsThePresetsWhereANameIsUnknown) {
  const auto config = find_config("kiti");
  ASSERT_FALSE(config);
  EXPECT_EQ(config.error().kind, Error::Kind::input);
  EXPECT_THAT(config.error().message,
              AllOf(HasSubstr("neither a file nor a preset (default, hilti2022"), HasSubstr("did you mean 'kitti'?")));
}

}  // namespace
}  // namespace pllit
