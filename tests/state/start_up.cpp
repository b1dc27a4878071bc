#include "pllit/state/start_up.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/imu_recording.hpp"
#include "support/random_states.hpp"
#include "support/recordings.hpp"

namespace pllit {
namespace {

namespace ix = error_index;
using test::Random;

struct Rest {
  SO3 R_W_I = SO3::Identity();
  Vector3d gyro_bias = Vector3d::Zero(), accel_bias = Vector3d::Zero();
  double gyro_noise = 0.002, accel_noise = 0.02;  // standard deviation of a sample
  double accel_scale = 1.0;
};

std::vector<ImuSample> at_rest(Random& random, const Rest& rest, double length_s = 1.5, double rate_hz = 200.0) {
  std::vector<ImuSample> imu;
  for (int i = 0; i <= std::lround(length_s * rate_hz); ++i) {
    const Vector3d force = rest.R_W_I.inverse().act(Vector3d(0.0, 0.0, 9.81)) + rest.accel_bias;
    imu.push_back({Time(from_seconds(i / rate_hz)), rest.gyro_bias + random.vector(rest.gyro_noise),
                   rest.accel_scale * (force + random.vector(rest.accel_noise))});
  }
  return imu;
}

Start started(const std::vector<ImuSample>& imu, const StartUpConfig& config = {}) {
  const auto start = start_up(imu, ImuNoise{}, config);
  EXPECT_TRUE(start.has_value()) << (start ? "" : start.error().message);
  EXPECT_TRUE(start->has_value());
  return **start;
}

double tilt_rad(const SO3& a, const SO3& b) {  // angle between the two verticals
  return std::acos(std::clamp(a.inverse().act(Vector3d::UnitZ()).dot(b.inverse().act(Vector3d::UnitZ())), -1.0, 1.0));
}

TEST(StartUp, FindsTheVerticalInAnyAttitudeWithHeadingZero) {
  Random random(11);
  for (int i = 0; i < 30; ++i) {
    const Rest rest{.R_W_I = i == 0 ? exp_so3({M_PI, 0.0, 0.0}) : random.rotation()};  // 0: mounted upside down
    const Start start = started(at_rest(random, rest));
    EXPECT_TRUE(start.still);
    EXPECT_LT(tilt_rad(start.estimate.mean.R_W_I, rest.R_W_I), 1e-3);
    EXPECT_NEAR(start.estimate.mean.R_W_I.act(Vector3d::UnitX()).y(), 0.0, 1e-9);
  }
}

TEST(StartUp, TakesTheGyroBiasFromRest) {
  Random random(12);
  const Rest rest{.gyro_bias = Vector3d(0.003, -0.002, 0.004)};
  const Start start = started(at_rest(random, rest));
  EXPECT_LT((start.estimate.mean.gyro_bias - rest.gyro_bias).norm(), 5e-4);
}

TEST(StartUp, BelievesAHorizontalBiasThatGravityConfirms) {
  Random random(13);
  const Rest rest{.gyro_bias = Vector3d(0.05, 0.0, 0.0)};
  const Start start = started(at_rest(random, rest, 3.0), {.window_s = 2.0});
  EXPECT_TRUE(start.still);
  EXPECT_NEAR(start.estimate.mean.gyro_bias.x(), 0.05, 1e-3);
}

TEST(StartUp, TakesASlowSteadyTurnForMotion) {
  Random random(14);
  for (const Vector3d& axis : {Vector3d(Vector3d::UnitX()), Vector3d(Vector3d::UnitZ())}) {
    std::vector<ImuSample> imu;
    for (int i = 0; i <= 400; ++i) {
      const SO3 R_W_I = exp_so3(0.05 * axis * i * 0.005);
      imu.push_back({Time(from_seconds(i * 0.005)), 0.05 * axis + random.vector(0.002),
                     R_W_I.inverse().act(Vector3d(0.0, 0.0, 9.81)) + random.vector(0.02)});
    }
    const Start start = started(imu);
    EXPECT_FALSE(start.still) << axis.transpose();
    EXPECT_EQ(start.estimate.mean.gyro_bias.norm(), 0.0);
  }
}

TEST(StartUp, DecidesTheUnitOnceAndReportsIt) {
  Random random(15);
  const Start in_g = started(at_rest(random, {.accel_scale = 1.0 / 9.80665}));
  EXPECT_EQ(in_g.unit, AccelUnit::g);
  EXPECT_THAT(in_g.report, testing::HasSubstr("accelerometer in g"));
  EXPECT_NEAR(in_g.estimate.mean.gravity_W.norm(), 9.81, 0.02);
  EXPECT_EQ(started(at_rest(random, {})).unit, AccelUnit::mps2);
}

TEST(StartUp, RefusesAnAccelerometerInNeitherUnit) {
  Random random(16);
  const auto start = start_up(at_rest(random, {.accel_scale = 0.4}), ImuNoise{}, {});
  ASSERT_FALSE(start.has_value());
  EXPECT_EQ(start.error().kind, Error::Kind::input);
  EXPECT_THAT(start.error().message, testing::HasSubstr("input.accel_unit"));
}

TEST(StartUp, DoesNotTakeABiasAlongGravityForAScaleError) {
  // Peers rescale every sample by 9.81 over the mean norm; here the known length of gravity makes it a bias.
  Random random(17);
  const Start start = started(at_rest(random, {.accel_bias = Vector3d(0.0, 0.0, 0.15)}));
  EXPECT_NEAR(start.estimate.mean.accel_bias.z(), 0.15, 0.02);
  EXPECT_NEAR(start.estimate.mean.gravity_W.z(), -9.81, 0.02);
}

TEST(StartUp, WaitsForEnoughData) {
  Random random(18);
  const auto start = start_up(at_rest(random, {}, 0.5), ImuNoise{}, {});
  ASSERT_TRUE(start.has_value());
  EXPECT_FALSE(start->has_value());
}

TEST(StartUp, RefusesAMovingRigWhereStillIsDemanded) {
  Random random(19);
  const auto start = start_up(at_rest(random, {.gyro_noise = 0.3}), ImuNoise{}, {.mode = StartMode::still});
  ASSERT_FALSE(start.has_value());
  EXPECT_THAT(start.error().message, testing::HasSubstr("start.mode"));
}

TEST(StartUp, ClaimsTheErrorsThatItMakes) {
  // Over many starts the error of the joint estimate of gravity and biases must be as large as its covariance says.
  Random random(20);
  const ImuNoise noise;
  double nees = 0.0;
  constexpr int runs = 300;
  for (int i = 0; i < runs; ++i) {
    Rest rest{.R_W_I = random.rotation()};
    rest.gyro_bias = random.vector(0.002);
    rest.accel_bias = random.vector(noise.accel_bias_sigma);
    rest.gyro_noise = noise.gyro_density * std::sqrt(200.0);
    rest.accel_noise = noise.accel_density * std::sqrt(200.0);
    const StartUpConfig lenient{.still_gyro_spread_rps = 0.1,
                                .still_accel_spread_mps2 = 1.0,
                                .still_slow_spread_rps = 0.1,
                                .still_rate_rps = 0.05};  // this test's noise is large
    const auto start = start_up(at_rest(random, rest), noise, lenient);
    ASSERT_TRUE(start && *start && (*start)->still);
    const Estimate& estimate = (*start)->estimate;
    // Truth in the start's own world, in which its attitude is exact by definition.
    const Vector3d gravity_W = (estimate.mean.R_W_I * rest.R_W_I.inverse()).act(Vector3d(0.0, 0.0, -9.81));
    Eigen::Matrix<double, 9, 1> error;
    error << rest.gyro_bias - estimate.mean.gyro_bias, rest.accel_bias - estimate.mean.accel_bias,
        gravity_W - estimate.mean.gravity_W;
    const Eigen::Matrix<double, 9, 9> P = estimate.covariance.bottomRightCorner<9, 9>();
    nees += error.dot(P.ldlt().solve(error)) / runs;
  }
  // The truth has no error in gravity's length (one of nine freedoms), the rest is chi-square: 8 +- 0.7.
  EXPECT_GT(nees, 7.0);
  EXPECT_LT(nees, 9.5);
}

TEST(StartUp, TakesNoStretchOfAHandCarriedRecordingForRest) {
  PLLIT_RECORDING(path, "imu_continuous/imu.txt");
  const auto imu = test::read_imu_text(path);
  ASSERT_GT(imu.size(), 20000u);
  EXPECT_EQ(accel_unit_of(std::span(imu).first(100), AccelUnit::automatic).value(), AccelUnit::mps2);
  int still = 0, windows = 0;
  for (std::size_t i = 0; i + 101 <= imu.size(); i += 25, ++windows)
    still += measure_stillness(std::span(imu).subspan(i, 101), {}).still;
  EXPECT_GT(windows, 900);
  EXPECT_EQ(still, 0);
  const Start start = started(std::vector(imu.begin(), imu.begin() + 110));
  EXPECT_FALSE(start.still);
  EXPECT_EQ(start.estimate.mean.gyro_bias.norm(), 0.0);
}

}  // namespace
}  // namespace pllit
