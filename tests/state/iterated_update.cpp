#include "pllit/state/iterated_update.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/random_states.hpp"

namespace pllit {
namespace {

namespace ix = error_index;
using test::Random;

/// A sensor that measures the whole pose with the given information.
Linearize pose_sensor(const SE3& measured, double weight) {
  return [measured, weight](const NavState& x) {
    NormalEquations sums;
    Vector6 r;
    r << log_so3(measured.asSO3().inverse() * x.R_W_I), x.p_W - measured.translation();
    Matrix6 J = Matrix6::Identity();
    J.topLeftCorner<3, 3>() = right_jacobian_inverse(r.head<3>());
    sums.H.topLeftCorner<6, 6>() = weight * J.transpose() * J;
    sums.b.head<6>() = -weight * J.transpose() * r;
    sums.cost = weight * r.squaredNorm();
    sums.inliers = sums.candidates = 6;
    return sums;
  };
}

FilterConfig many_iterations() {
  return {.max_iterations = 50, .rotation_tolerance_rad = 1e-12, .position_tolerance_m = 1e-12};
}

TEST(IteratedUpdate, EqualsTheKalmanGainFormOnALinearSensor) {
  Random random(7);
  Estimate prior;
  prior.covariance = random.covariance(0.1);
  const Vector3d measured_p(0.3, -0.2, 0.1);
  const double sigma = 0.05;
  const auto sensor = [&](const NavState& x) {
    NormalEquations sums;
    sums.H.block<3, 3>(ix::p, ix::p) = Matrix3d::Identity() / (sigma * sigma);
    sums.b.segment<3>(ix::p) = (measured_p - x.p_W) / (sigma * sigma);
    sums.inliers = 3;
    return sums;
  };
  const auto result = iterated_update(prior, sensor, many_iterations());

  Eigen::Matrix<double, 3, 18> H = Eigen::Matrix<double, 3, 18>::Zero();
  H.block<3, 3>(0, ix::p).setIdentity();
  const Matrix3d S = H * prior.covariance * H.transpose() + sigma * sigma * Matrix3d::Identity();
  const Eigen::Matrix<double, 18, 3> K = prior.covariance * H.transpose() * S.inverse();
  // The position measurement turns the attitude by a small angle too, where the two forms differ in second order only.
  const Vector18 gain = K * measured_p;
  EXPECT_LT((boxminus(result.posterior.mean, prior.mean) - gain).tail<15>().norm(), 1e-9);
  const Matrix18 P = (Matrix18::Identity() - K * H) * prior.covariance;
  EXPECT_LT((result.posterior.covariance - P).bottomRightCorner(15, 15).norm(), 1e-9);
}

TEST(IteratedUpdate, FindsTheMinimumOfPriorAndMeasurementCost) {
  Random random(8);
  for (int i = 0; i < 20; ++i) {
    Estimate prior{.mean = random.state(), .covariance = random.covariance(0.3)};
    const SE3 measured = pose_from(prior.mean.R_W_I * exp_so3(random.vector(0.4)), prior.mean.p_W + random.vector(0.5));
    const double weight = 20.0;
    const auto result = iterated_update(prior, pose_sensor(measured, weight), many_iterations());
    ASSERT_TRUE(result.converged);
    const Matrix18 information = prior.covariance.inverse();
    const auto cost = [&](const NavState& x) {
      const Vector18 d = boxminus(x, prior.mean);
      return d.dot(information * d) + pose_sensor(measured, weight)(x).cost;
    };
    const double lowest = cost(result.posterior.mean);
    for (int k = 0; k < 40; ++k) {
      const Vector18 nudge = Vector18::NullaryExpr([&] { return random.normal(1e-3); });
      EXPECT_GT(cost(boxplus(result.posterior.mean, nudge)), lowest);
    }
  }
}

TEST(IteratedUpdate, PosteriorCovarianceIsTheInverseOfTheCostsCurvature) {
  Random random(9);
  Estimate prior{.mean = random.state(), .covariance = random.covariance(0.02)};
  const SE3 measured = pose_from(prior.mean.R_W_I * exp_so3(random.vector(0.01)), prior.mean.p_W + random.vector(0.02));
  const auto result = iterated_update(prior, pose_sensor(measured, 1e3), many_iterations());
  Matrix18 information = prior.covariance.inverse();
  information.topLeftCorner<6, 6>() += 1e3 * Matrix6::Identity();
  const Matrix18 expected = information.inverse();
  EXPECT_LT((result.posterior.covariance - expected).norm() / expected.norm(), 0.02);
}

TEST(IteratedUpdate, LeavesThePriorAloneWithoutResiduals) {
  Random random(10);
  const Estimate prior{.mean = random.state(), .covariance = random.covariance(0.1)};
  const auto result = iterated_update(prior, [](const NavState&) { return NormalEquations{}; }, {});
  EXPECT_EQ(result.posterior.mean.R_W_I.coeffs(), prior.mean.R_W_I.coeffs());
  EXPECT_EQ(result.posterior.mean.p_W, prior.mean.p_W);
  EXPECT_EQ(result.posterior.covariance, prior.covariance);
}

TEST(IteratedUpdate, CarriesAnUnobservedDirectionByThePrior) {
  Estimate prior;
  prior.covariance = 0.01 * Matrix18::Identity();
  const auto sees_y_and_z = [](const NavState& x) {
    NormalEquations sums;
    sums.H(ix::p + 1, ix::p + 1) = sums.H(ix::p + 2, ix::p + 2) = 1e6;
    sums.b.segment<3>(ix::p) = Vector3d(0.0, 1e6 * (0.05 - x.p_W.y()), 1e6 * (0.05 - x.p_W.z()));
    sums.inliers = 2;
    return sums;
  };
  const auto posterior = iterated_update(prior, sees_y_and_z, {}).posterior;
  EXPECT_EQ(posterior.mean.p_W.x(), 0.0);
  EXPECT_DOUBLE_EQ(posterior.covariance(ix::p, ix::p), 0.01);
  EXPECT_NEAR(posterior.mean.p_W.y(), 0.05, 1e-4);
}

TEST(IteratedUpdate, GivesNoGainToADirectionThatTheSensorCallsUnobserved) {
  // A sensor of z whose normal is off by 0.005: with a metre of doubt about x and a millimetre about z, the full gain
  // would move x by decimetres to explain a millimetre of noise.
  Estimate prior;
  prior.covariance = 1e-6 * Matrix18::Identity();
  prior.covariance(ix::p, ix::p) = 1.0;
  const Vector3d normal = Vector3d(0.005, 0.0, 1.0).normalized();
  const auto sensor = [&](bool says_so) {
    return [&normal, says_so](const NavState& x) {
      NormalEquations sums;
      sums.H.block<3, 3>(ix::p, ix::p) = 1e6 * normal * normal.transpose();
      sums.b.segment<3>(ix::p) = 1e6 * normal * (0.001 - normal.dot(x.p_W));
      sums.inliers = 1;
      if (says_so) sums.unobserved = Vector18::Unit(ix::p);
      return sums;
    };
  };
  EXPECT_GT(std::abs(iterated_update(prior, sensor(false), {}).posterior.mean.p_W.x()), 0.05);
  const Estimate posterior = iterated_update(prior, sensor(true), {}).posterior;
  EXPECT_NEAR(posterior.mean.p_W.x(), 0.0, 1e-12);
  EXPECT_NEAR(posterior.covariance(ix::p, ix::p), 1.0, 1e-9);
  EXPECT_GT(posterior.mean.p_W.z(), 0.0);
  const Eigen::SelfAdjointEigenSolver<Matrix18> eigen(posterior.covariance);
  EXPECT_GT(eigen.eigenvalues()[0], 0.0);
}

TEST(IteratedUpdate, AcceptsAPriorThatIsCertainInSomeDirections) {
  Estimate prior;
  prior.covariance = 0.01 * Matrix18::Identity();
  prior.covariance.row(ix::p).setZero();
  prior.covariance.col(ix::p).setZero();
  const auto posterior =
      iterated_update(prior, pose_sensor(pose_from(SO3::Identity(), {1.0, 0.1, 0.0}), 100.0), {}).posterior;
  EXPECT_NEAR(posterior.mean.p_W.x(), 0.0, 1e-12);
  EXPECT_TRUE(posterior.covariance.allFinite());
}

}  // namespace
}  // namespace pllit
