#include "pllit/state/propagation.hpp"

#include <gtest/gtest.h>

#include "support/random_states.hpp"

namespace pllit {
namespace {

namespace ix = error_index;
using namespace std::chrono_literals;
using test::Random;

ImuNoise strong_noise() {
  ImuNoise noise;
  noise.gyro_density = 0.01;
  noise.accel_density = 0.1;
  return noise;
}

/// A random state at time 0, known exactly.
Estimate known_start(Random& random) {
  Estimate start;
  start.mean = random.state();
  start.mean.time = Time{};
  return start;
}

/// Samples of a constant rate and specific force from time 0 on.
std::vector<ImuSample> constant_imu(const Vector3d& gyro, const Vector3d& accel, double rate_hz, double length_s) {
  std::vector<ImuSample> imu;
  for (int i = 0; i <= std::lround(length_s * rate_hz); ++i)
    imu.push_back({Time(from_seconds(i / rate_hz)), gyro, accel});
  return imu;
}

TEST(ImuStep, JacobianToTheErrorMatchesCentralDifferences) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const NavState x = random.state();
    const Vector3d gyro = random.vector(1.0), accel = random.vector(10.0);
    const ImuStep step = imu_step(x, gyro, accel, 20ms);
    const Matrix18 J = test::numerical_jacobian<18, 18>(
        [&](const Vector18& d) { return boxminus(imu_step(boxplus(x, d), gyro, accel, 20ms).state, step.state); });
    EXPECT_LT((step.J_next_error - J).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(ImuStep, JacobianToTheNoiseMatchesCentralDifferences) {
  Random random(4);
  using Vector12 = Eigen::Matrix<double, 12, 1>;
  for (int i = 0; i < 50; ++i) {
    const NavState x = random.state();
    const Vector3d gyro = random.vector(1.0), accel = random.vector(10.0);
    const Duration dt = 20ms;
    const ImuStep step = imu_step(x, gyro, accel, dt);
    const auto with_noise = [&](const Vector12& n) -> Vector18 {  // the paper's f(x, u, w)
      NavState next = imu_step(x, gyro - n.segment<3>(0), accel - n.segment<3>(3), dt).state;
      next.gyro_bias += n.segment<3>(6) * to_seconds(dt);
      next.accel_bias += n.segment<3>(9) * to_seconds(dt);
      return boxminus(next, step.state);
    };
    EXPECT_LT((step.J_next_noise - test::numerical_jacobian<18, 12>(with_noise)).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(Propagate, FallsFreelyAsPhysicsSays) {
  Estimate start;
  start.mean.v_W = Vector3d(1.0, 0.0, 5.0);
  const auto result =
      propagate(start, constant_imu(Vector3d::Zero(), Vector3d::Zero(), 200.0, 1.0), Time(1s), ImuNoise{});
  EXPECT_LT((result.predicted.mean.p_W - Vector3d(1.0, 0.0, 5.0 - 0.5 * 9.81)).norm(), 1e-9);
  EXPECT_LT((result.predicted.mean.v_W - Vector3d(1.0, 0.0, 5.0 - 9.81)).norm(), 1e-9);
}

TEST(Propagate, EndsAtTheTimeAskedForBetweenTwoSamples) {
  Estimate start;
  start.mean.time = Time(13ms);
  const auto imu = constant_imu({0.0, 0.0, 1.0}, {0.0, 0.0, 9.81}, 100.0, 0.2);
  const auto result = propagate(start, imu, Time(157ms), ImuNoise{});
  EXPECT_EQ(result.predicted.mean.time, Time(157ms));
  EXPECT_NEAR(log_so3(result.predicted.mean.R_W_I).z(), 0.144, 1e-12);
  EXPECT_LT(result.predicted.mean.p_W.norm(), 1e-12);
}

TEST(Propagate, ClaimsTheSameUncertaintyAtAnySampleRate) {
  // The same densities at 10 Hz and at 1 kHz: after one second the covariance must agree but for the finer steps.
  ImuNoise noise;
  noise.gyro_bias_walk = 1e-3;
  noise.accel_bias_walk = 1e-2;
  Matrix18 reference = Matrix18::Zero();
  for (const double rate_hz : {1000.0, 400.0, 100.0, 50.0, 10.0}) {
    Estimate start;
    const auto imu = constant_imu({0.0, 0.0, 0.3}, {0.2, 0.0, 9.81}, rate_hz, 1.0);
    const Matrix18 P = propagate(start, imu, Time(1s), noise, {.max_gap = 1s}).predicted.covariance;
    if (rate_hz == 1000.0) reference = P;
    for (int i = 0; i < 15; ++i)
      EXPECT_NEAR(P(i, i) / reference(i, i), 1.0, 0.3) << "axis " << i << " at " << rate_hz << " Hz";
    EXPECT_NEAR(P(ix::theta, ix::theta), noise.gyro_density * noise.gyro_density + 1e-6 / 3.0, 2e-6);
  }
}

TEST(Propagate, CovarianceMatchesTheSpreadOfNoisyRuns) {
  Random random(5);
  const double rate_hz = 100.0;
  const ImuNoise noise = strong_noise();
  Estimate start = known_start(random);
  const auto clean = constant_imu({0.3, -0.2, 0.5}, {1.0, 0.5, 9.0}, rate_hz, 0.5);
  const auto predicted = propagate(start, clean, Time(500ms), noise).predicted;
  Matrix18 spread = Matrix18::Zero();
  constexpr int runs = 2000;
  for (int run = 0; run < runs; ++run) {
    // Steps use the mean of two samples, so noise is drawn per step: a sample between two steps serves one of them.
    Estimate noisy = start;
    for (std::size_t i = 0; i + 1 < clean.size(); ++i)
      noisy.mean = imu_step(noisy.mean, clean[i].gyro_rps + random.vector(noise.gyro_density * std::sqrt(rate_hz)),
                            clean[i].accel_mps2 + random.vector(noise.accel_density * std::sqrt(rate_hz)), 10ms)
                       .state;
    const Vector18 error = boxminus(noisy.mean, predicted.mean);
    spread += error * error.transpose() / runs;
  }
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(spread(i, i) / predicted.covariance(i, i), 1.0, 0.12) << "axis " << i;
}

TEST(Sweep, CovariancesMatchTheSpreadOfNoisyRuns) {
  // Twin: the mean over the sweep of where each instant's pose
  // error would put the end, and the error of the end itself.
  Random random(6);
  const double rate_hz = 100.0;
  const ImuNoise noise = strong_noise();
  Estimate start = known_start(random);
  start.mean.v_W = Vector3d(5.0, 0.0, 0.0);
  const Vector3d gyro(0.3, -0.2, 0.5), accel(1.0, 0.5, 9.0);
  const auto clean = constant_imu(gyro, accel, rate_hz, 0.3);
  const Propagation predicted = propagate(start, clean, Time(300ms), noise, {}, Time(100ms));
  const auto steps = clean.size() - 1;
  Eigen::Matrix<double, 12, 12> spread = Eigen::Matrix<double, 12, 12>::Zero();
  constexpr int runs = 4000;
  for (int run = 0; run < runs; ++run) {
    NavState truth = start.mean;
    Vector6 mean_error = Vector6::Zero();
    for (std::size_t i = 0; i <= steps; ++i) {
      if (i >= 10) {  // the end as the predicted motion from here would give it, trapezoidally averaged
        const double share = (i == 10 || i == steps ? 0.5 : 1.0) / static_cast<double>(steps - 10);
        const SE3 end = truth.T_W_I() * predicted.path.pose_at(truth.time).inverse() * predicted.predicted.mean.T_W_I();
        mean_error.head<3>() += share * log_so3(predicted.predicted.mean.R_W_I.inverse() * end.asSO3());
        mean_error.tail<3>() += share * (end.translation() - predicted.predicted.mean.p_W);
      }
      if (i < steps)
        truth = imu_step(truth, gyro + random.vector(noise.gyro_density * std::sqrt(rate_hz)),
                         accel + random.vector(noise.accel_density * std::sqrt(rate_hz)), 10ms)
                    .state;
    }
    Eigen::Matrix<double, 12, 1> both;
    both << mean_error, boxminus(truth, predicted.predicted.mean).head<6>();
    spread += both * both.transpose() / runs;
  }
  Eigen::Matrix<double, 12, 12> claimed;
  claimed << predicted.sweep.estimate.covariance.topLeftCorner<6, 6>(),
      predicted.sweep.with_end.topLeftCorner<6, 6>().transpose(), predicted.sweep.with_end.topLeftCorner<6, 6>(),
      predicted.predicted.covariance.topLeftCorner<6, 6>();
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      EXPECT_NEAR(spread(i, j), claimed(i, j), 0.1 * std::sqrt(claimed(i, i) * claimed(j, j))) << i << ", " << j;
}

TEST(Sweep, OfAnInstantLeavesTheUpdateAsItIs) {
  Random random(7);
  Estimate start = known_start(random);
  start.covariance = 0.01 * Matrix18::Identity();
  const auto imu = constant_imu({0.3, -0.2, 0.5}, {1.0, 0.5, 9.0}, 100.0, 0.1);
  const Propagation motion = propagate(start, imu, Time(100ms), ImuNoise{});
  UpdateResult update;
  update.posterior = {.mean = boxplus(motion.predicted.mean, Vector18::Constant(0.01)),
                      .covariance = 0.5 * motion.predicted.covariance};
  update.J_posterior_prior = 0.5 * Matrix18::Identity();
  const SmoothedEnd end = at_end(motion, update);
  EXPECT_LT(boxminus(end.estimate.mean, update.posterior.mean).norm(), 1e-9);
  EXPECT_LT((end.estimate.covariance - update.posterior.covariance).norm(), 1e-9);
  EXPECT_LT((end.J_end_begin - 0.5 * motion.J_end_begin).norm(), 1e-9);
}

TEST(Sweep, JacobiansToTheBeginningEqualCentralDifferences) {
  Random random(9);
  Estimate start = known_start(random);
  const Vector3d gyro(0.3, -0.2, 0.5), accel(1.0, 0.5, 9.0);
  const auto imu = constant_imu(gyro, accel, 100.0, 0.3);
  const Propagation motion = propagate(start, imu, Time(300ms), ImuNoise{}, {}, Time(100ms));
  const NavState& end = motion.predicted.mean;
  // Errors of the sweep's mean pose, and at the end, of a truth that began `error` away.
  const auto errors = [&](const Vector18& error) {
    Estimate truth{.mean = boxplus(start.mean, error)};
    Eigen::Matrix<double, 36, 1> both = Eigen::Matrix<double, 36, 1>::Zero();
    for (std::size_t i = 0; i + 1 <= imu.size(); ++i) {
      if (i >= 10) {
        const double share = (i == 10 || i + 1 == imu.size() ? 0.5 : 1.0) / static_cast<double>(imu.size() - 11);
        const SE3 there = truth.mean.T_W_I() * motion.path.pose_at(truth.mean.time).inverse() * end.T_W_I();
        both.segment<3>(0) += share * log_so3(end.R_W_I.inverse() * there.asSO3());
        both.segment<3>(3) += share * (there.translation() - end.p_W);
      }
      if (i + 1 < imu.size()) truth.mean = imu_step(truth.mean, gyro, accel, 10ms).state;
    }
    both.tail<18>() = boxminus(truth.mean, end);
    both.segment<12>(6) = both.tail<12>();
    return both;
  };
  constexpr double step = 1e-5;
  for (int i = 0; i < ix::size; ++i) {
    const Eigen::Matrix<double, 36, 1> slope =
        (errors(step * Vector18::Unit(i)) - errors(-step * Vector18::Unit(i))) / (2.0 * step);
    EXPECT_LT((slope.head<18>() - motion.sweep.J_estimate_begin.col(i)).norm(), 2e-4) << i;
    EXPECT_LT((slope.tail<18>() - motion.J_end_begin.col(i)).norm(), 1e-6) << i;
  }
}

TEST(Propagate, GoesStraightOnThroughAGapAndDoubtsIt) {
  Estimate start;
  start.mean.v_W = Vector3d(2.0, 0.0, 0.0);
  auto imu = constant_imu(Vector3d::Zero(), {0.0, 0.0, 9.81}, 100.0, 2.0);
  std::erase_if(imu, [](const ImuSample& s) { return s.time > Time(200ms) && s.time < Time(1500ms); });
  const auto result = propagate(start, imu, Time(2s), ImuNoise{});
  EXPECT_LT((result.predicted.mean.p_W - Vector3d(4.0, 0.0, 0.0)).norm(), 1e-9);
  EXPECT_GE(result.longest_gap, 1300ms);
  EXPECT_GT(std::sqrt(result.predicted.covariance(ix::p, ix::p)), 1.0);
}

TEST(Propagate, DoesNotTrustAReadingThatIsHeldOverManyShortPackets) {
  // A rig that accelerated when its IMU fell silent: each packet is shorter than the gap, all together are not.
  Estimate estimate;
  const auto imu = constant_imu(Vector3d::Zero(), {5.0, 0.0, 9.81}, 100.0, 0.1);
  for (int i = 1; i <= 20; ++i) estimate = propagate(estimate, imu, Time(i * 100ms), ImuNoise{}).predicted;
  EXPECT_LT(estimate.mean.v_W.x(), 2.0);
  EXPECT_GT(std::sqrt(estimate.covariance(ix::v, ix::v)), 0.5);
}

TEST(Propagate, StaysFiniteWithoutAnyImuData) {
  Estimate start;
  start.mean.v_W = Vector3d(1.0, 0.0, 0.0);
  const auto result = propagate(start, {}, Time(3s), ImuNoise{});
  EXPECT_NEAR(result.predicted.mean.p_W.x(), 3.0, 1e-9);
  EXPECT_EQ(result.longest_gap, 3s);
  EXPECT_TRUE(result.predicted.covariance.allFinite());
  EXPECT_EQ(result.path.nodes.back().time, Time(3s));
}

TEST(MotionPath, PassesThroughItsNodesAndContinuesBackwards) {
  Random random(6);
  Estimate start;
  start.mean = random.state();
  start.mean.time = Time{};
  const auto imu = constant_imu({0.5, 0.1, -0.4}, {1.0, 2.0, 9.0}, 50.0, 0.2);
  const auto path = propagate(start, imu, Time(190ms), ImuNoise{}).path;
  for (const PathNode& node : path.nodes) {
    const SE3 T_W_I = path.pose_at(node.time);
    EXPECT_LT((T_W_I.translation() - node.p_W).norm(), 1e-9);
    EXPECT_LT(log_so3(T_W_I.asSO3().inverse() * node.R_W_I).norm(), 1e-9);
  }
  const SE3 before = path.pose_at(Time(-10ms));
  EXPECT_LT((before.translation() - (start.mean.p_W - 0.01 * start.mean.v_W)).norm(), 1e-3);
}

}  // namespace
}  // namespace pllit
