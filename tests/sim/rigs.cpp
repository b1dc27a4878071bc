#include "pllit/sim/rigs.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "pllit/slam/config_presets.hpp"

namespace pllit {
namespace {

using Name = SimConfig::RigName;

double angle_deg(const SE3& a, const SE3& b) {
  return log_so3(a.asSO3().inverse() * b.asSO3()).norm() * 180.0 / std::numbers::pi;
}

TEST(SimRigs, AreMountedAsTheEstimatorsPresetsSay) {
  for (const Name name : {Name::hilti2022, Name::ntu4dradlm, Name::inspection}) {
    const SimRig sim = sim_rig(name);
    const auto preset = find_config(sim.name);
    ASSERT_TRUE(preset) << sim.name;
    const Rig rig = make_rig(preset->rig), known = sim.known();
    EXPECT_LT(angle_deg(rig.T_I_L, known.T_I_L), 1e-3) << sim.name;
    EXPECT_LT((rig.T_I_L.translation() - known.T_I_L.translation()).norm(), 1e-6) << sim.name;
    EXPECT_LT(angle_deg(rig.T_I_C, known.T_I_C), 1e-3) << sim.name;
    EXPECT_LT((rig.T_I_C.translation() - known.T_I_C.translation()).norm(), 1e-6) << sim.name;
    EXPECT_NEAR(rig.imu.gyro_density, known.imu.gyro_density, 1e-9) << sim.name;
    EXPECT_NEAR(rig.imu.accel_bias_walk, known.imu.accel_bias_walk, 1e-9) << sim.name;
    EXPECT_NEAR(rig.camera->fx, known.camera->fx, 1e-9) << sim.name;
  }
}

TEST(SimRigs, LookAheadWhenCarriedUpright) {
  for (const Name name : {Name::hilti2022, Name::ntu4dradlm, Name::inspection}) {
    const SimRig rig = sim_rig(name);
    const Vector3d looks_B = rig.R_B_I.act(rig.T_I_C.asSO3().act(Vector3d::UnitZ()));
    EXPECT_GT(looks_B.x(), 0.99) << rig.name;
  }
}

TEST(SimRigs, AreBuiltUnlikeTheirDataSheetWithinTheStatedBounds) {
  const SimRig sheet = sim_rig(Name::inspection);
  double least_deg = 1.0, most_deg = 0.0, least_m = 1.0, most_m = 0.0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const SimRig built = as_built(sheet, seed);
    const double turn = angle_deg(sheet.T_I_C, built.T_I_C),
                 shift = (sheet.T_I_C.inverse() * built.T_I_C).translation().norm();
    least_deg = std::min(least_deg, turn);
    most_deg = std::max(most_deg, turn);
    least_m = std::min(least_m, shift);
    most_m = std::max(most_m, shift);
    EXPECT_NEAR(built.camera()->fx / sheet.camera()->fx, 1.0, 0.003);
    EXPECT_LE(std::abs(to_seconds(built.lidar_clock)), 0.005);
    EXPECT_LE(std::abs(std::log2(built.imu.noise.gyro_density / sheet.imu.noise.gyro_density)), 1.0);
    EXPECT_NE(built.lidar.unit.range_m, 0.0);
    EXPECT_EQ(built.lidar.unit.line_range_m.size(), 4U);
    EXPECT_EQ(without_errors(built).lidar.unit.range_m, 0.0);
  }
  EXPECT_NEAR(least_deg, 0.1, 0.01);
  EXPECT_NEAR(most_deg, 0.3, 0.01);
  EXPECT_NEAR(least_m, 0.005, 0.001);
  EXPECT_NEAR(most_m, 0.015, 0.001);
}

}  // namespace
}  // namespace pllit
