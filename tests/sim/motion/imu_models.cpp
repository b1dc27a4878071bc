#include "pllit/sim/motion/imu_models.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace pllit {
namespace {

TEST(ImuModels, AreKnownByName) {
  for (const std::string& name : imu_model_names()) EXPECT_TRUE(imu_model(name)) << name;
  const auto unknown = imu_model("bmi999");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().kind, Error::Kind::input);
  EXPECT_THAT(unknown.error().message, testing::AllOf(testing::HasSubstr("bmi999"), testing::HasSubstr("vn100")));
}

TEST(ImuModels, HaveRangesThatTheirCountsCanReach) {
  for (const std::string& name : imu_model_names()) {
    const ImuModel model = *imu_model(name);
    EXPECT_LE(model.gyro_range_rps / model.gyro_lsb_rps, 1e5 + 1.0) << name;
    EXPECT_LE(model.accel_range_mps2 / model.accel_lsb_mps2, 32768.5) << name;
    EXPECT_GT(model.accel_range_mps2, 5.0 * kStandardGravity_mps2) << name;
    EXPECT_GE(model.rate_hz, 200.0) << name;
  }
}

TEST(ImuModels, AgreeWithTheMakersFigures) {
  EXPECT_NEAR(imu_model("bmi088")->noise.gyro_density, 2.44e-4, 1e-6);
  EXPECT_NEAR(imu_model("bmi088")->accel_range_mps2, 235.4, 0.1);
  EXPECT_NEAR(imu_model("vn100")->noise.gyro_density, 6.10866e-5, 1e-9);
  EXPECT_NEAR(imu_model("vn100")->noise.accel_density, 1.372e-3, 2e-6);
  EXPECT_NEAR(bias_walk(0.04e-3 * kStandardGravity_mps2), 3.9e-5, 1e-6);
  EXPECT_EQ(imu_model("alphasense")->gyro_range_rps, 7.5);
}

}  // namespace
}  // namespace pllit
