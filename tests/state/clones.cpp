#include "pllit/state/clones.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/random_states.hpp"

namespace pllit {
namespace {

namespace ix = error_index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::Random;

/// A state with two clones whose errors are random sums of each other's.
struct Joint {
  Estimate estimate;
  Clones clones;
};

/// Of an image that is exposed at its time.
Exposure in_time(const Estimate& estimate) { return exposure(estimate.mean, 0.0, Vector3d::Zero()); }

Joint random_joint(Random& random) {
  Joint joint{.estimate = {.mean = random.state(), .covariance = random.covariance(0.1)}, .clones = {}};
  for (int i = 0; i < 2; ++i) {
    add_clone(joint.clones, joint.estimate, in_time(joint.estimate));
    const Matrix18 J = Matrix18::Identity() + 0.3 * Matrix18::NullaryExpr([&] { return random.normal(0.1); });
    carry(joint.clones, J);
    joint.estimate.covariance = J * joint.estimate.covariance * J.transpose() + random.covariance(0.02);
    joint.estimate.mean = boxplus(joint.estimate.mean, Vector18::Constant(0.05));
  }
  return joint;
}

/// Measures where the state is seen from clone 1, in W: linear in the errors but for the turn of the state's own frame.
LinearizeJoint relative_position(const Joint& joint, const Vector3d& measured, double sigma) {
  const Vector3d from = joint.clones.poses[1].translation();
  return [=](const NavState& x, const CameraMount&) {
    JointEquations sums(2);
    MatrixXd J = MatrixXd::Zero(3, sums.H.cols());
    J.block<3, 3>(0, ix::p).setIdentity();
    J.block<3, 3>(0, joint_index::clone(1) + 3) = -Matrix3d::Identity();
    const Vector3d r = (x.p_W - from) - measured;
    sums.H = J.transpose() * J / (sigma * sigma);
    sums.b = -J.transpose() * r / (sigma * sigma);
    sums.cost = r.squaredNorm() / (sigma * sigma);
    sums.inliers = sums.candidates = 3;
    return sums;
  };
}

TEST(Clones, AFreshOneSharesItsWholeErrorWithTheState) {
  Random random(1);
  Joint joint = random_joint(random);
  add_clone(joint.clones, joint.estimate, in_time(joint.estimate));
  const MatrixXd P = joint_covariance(joint.estimate, joint.clones);
  MatrixXd difference = MatrixXd::Zero(6, P.cols());
  difference.leftCols<6>().setIdentity();
  difference.rightCols<6>() = -Matrix6::Identity();
  EXPECT_LT((difference * P * difference.transpose()).norm(), 1e-12);
  EXPECT_LT((P - P.transpose()).norm(), 1e-12);
}

TEST(Clones, RemovingOneLeavesTheOthersAsTheyWere) {
  Random random(2);
  Joint joint = random_joint(random);
  const Clones before = joint.clones;
  remove_clone(joint.clones, 0);
  ASSERT_EQ(joint.clones.size(), 1U);
  EXPECT_EQ(joint.clones.with_state.rightCols(6), before.with_state.rightCols(6));
  EXPECT_EQ(joint.clones.covariance.bottomRightCorner(6, 6), before.covariance.bottomRightCorner(6, 6));
  EXPECT_EQ(joint.clones.poses[0], before.poses[1]);
}

TEST(JointUpdate, EqualsTheSchmidtGainOnALinearSensor) {
  Random random(3);
  const Joint joint = random_joint(random);
  const Vector3d offset(0.02, -0.03, 0.01);
  const Vector3d predicted = joint.estimate.mean.p_W - joint.clones.poses[1].translation();
  const double sigma = 0.05;
  const auto update = iterated_update(joint.estimate, joint.clones, relative_position(joint, predicted + offset, sigma),
                                      FilterConfig{});

  const MatrixXd P = joint_covariance(joint.estimate, joint.clones);
  MatrixXd H = MatrixXd::Zero(3, P.cols());
  H.block<3, 3>(0, ix::p).setIdentity();
  H.block<3, 3>(0, joint_index::clone(1) + 3) = -Matrix3d::Identity();
  const Matrix3d S = H * P * H.transpose() + sigma * sigma * Matrix3d::Identity();
  MatrixXd K = P * H.transpose() * S.inverse();
  K.bottomRows(12).setZero();
  const Vector18 gain = (K * offset).head<18>();
  EXPECT_LT((boxminus(update.posterior.mean, joint.estimate.mean) - gain).tail<15>().norm(), 1e-9);
  const MatrixXd kept = MatrixXd::Identity(P.rows(), P.cols()) - K * H;
  const MatrixXd posterior = kept * P * kept.transpose() + sigma * sigma * K * K.transpose();
  const MatrixXd claimed = joint_covariance(update.posterior, update.clones);
  EXPECT_LT((claimed - posterior).bottomRightCorner(34, 34).norm(), 1e-6) << "but for the turn of the tangent space";
  EXPECT_LT((update.clones.covariance - joint.clones.covariance).norm(), 1e-12);
}

TEST(JointUpdate, KnowsTheWayFromAClonePreciselyHoweverUnsureBothAre) {
  Estimate estimate;
  estimate.covariance = 1e-6 * Matrix18::Identity();
  estimate.covariance.block<3, 3>(ix::p, ix::p) = Matrix3d::Identity();
  Clones clones;
  add_clone(clones, estimate, in_time(estimate));
  add_clone(clones, estimate, in_time(estimate));
  estimate.covariance.block<3, 3>(ix::p, ix::p) += 0.04 * Matrix3d::Identity();  // moved on with some doubt
  const Joint joint{estimate, clones};
  const auto update =
      iterated_update(estimate, clones, relative_position(joint, Vector3d(0.3, 0.0, 0.0), 0.01), FilterConfig{});
  EXPECT_NEAR(update.posterior.mean.p_W.x(), 0.3, 1e-3);
  EXPECT_NEAR(update.posterior.covariance(ix::p, ix::p), 1.0, 0.01) << "the clone's own error stays";
  const double relative = update.posterior.covariance(ix::p, ix::p) + 1.0 -
                          2.0 * update.clones.with_state(ix::p, joint_index::clone(0) + 3 - ix::size);
  EXPECT_NEAR(relative, 1e-4, 1e-5);
}

TEST(Clones, TheOneOfALateImageKnowsThatItShiftsWithTheDelay) {
  Random random(9);
  Estimate estimate{.mean = random.state(), .covariance = 1e-8 * Matrix18::Identity()};
  estimate.mean.v_W = Vector3d(2.0, 0.0, 0.0);
  MountMatrix covariance = MountMatrix::Zero();
  covariance(mount_index::delay, mount_index::delay) = 0.005 * 0.005;
  Clones clones = without_poses({}, covariance);
  add_clone(clones, estimate, exposure(estimate.mean, 0.01, Vector3d(0.0, 0.0, 0.8)));
  EXPECT_NEAR((clones.poses[0].translation() - estimate.mean.p_W).norm(), 0.02, 1e-12);
  const auto own = clones.covariance.bottomRightCorner<6, 6>();
  EXPECT_NEAR(std::sqrt(own(2, 2)), 0.8 * 0.005, 1e-5);
  EXPECT_NEAR(std::sqrt(own(3, 3)), 2.0 * 0.005, 1e-5);
  EXPECT_NEAR(clones.covariance(mount_index::delay, mount_index::size + 3), 2.0 * 0.005 * 0.005, 1e-9);
}

TEST(JointUpdate, ImprovesTheMountAsWellAsTheState) {
  // The state is known from elsewhere; the camera sees it from its own unknown place, turned and late, and everything
  // by a share nearer than it is.
  Estimate estimate;
  estimate.covariance = 1e-10 * Matrix18::Identity();
  estimate.mean.v_W = Vector3d(1.0, -0.5, 0.0);
  const Vector3d rate_I(0.2, -0.5, 1.0), place(0.1, 0.2, 0.3);
  const CameraMount truth{
      .T_I_C = pose_from(exp_so3(Vector3d(0.02, -0.01, 0.03)), place), .delay_s = 0.004, .depth_stretch = 0.01};
  MountVector sigmas;
  sigmas << Vector6::Constant(0.03), 0.005, 0.02;
  const Clones clones =
      without_poses({.T_I_C = pose_from(SO3::Identity(), place)}, sigmas.cwiseAbs2().asDiagonal().toDenseMatrix());
  // Turning one way and the other tells a delay from a turned mount.
  const std::vector<Vector3d> points{{4.0, 1.0, 0.5}, {5.0, -2.0, 1.0}, {3.0, 0.5, -1.0}, {-4.0, 3.0, 1.0}};
  const auto sensor = [&](const NavState& x, const CameraMount& mount) {
    JointEquations sums;
    for (const double way : {1.0, -1.0})
      for (const Vector3d& p_W : points) {
        const auto seen_by = [&](const CameraMount& by) {
          const SE3 T_W_I = exposure(x, by.delay_s, way * rate_I).T_W_I;
          return Vector3d((T_W_I * by.T_I_C).inverse().act(p_W) / (1.0 + by.depth_stretch));
        };
        const Vector3d r = seen_by(truth) - seen_by(mount);
        MatrixXd J = MatrixXd::Zero(3, sums.H.cols());
        for (int i = 0; i < mount_index::size; ++i)
          J.col(joint_index::mount + i) =
              (seen_by(mount) - seen_by(boxplus(mount, 1e-6 * MountVector::Unit(i)))) / 1e-6;
        sums.H += 1e6 * J.transpose() * J;
        sums.b -= 1e6 * J.transpose() * r;
        sums.cost += 1e6 * r.squaredNorm();
        sums.inliers += 3;
      }
    return sums;
  };
  const auto update = iterated_update(estimate, clones, sensor, FilterConfig{});
  const MountVector left = boxminus(update.clones.mount, truth);
  EXPECT_LT(left.head<3>().norm(), 1e-4);
  EXPECT_LT(left.segment<3>(mount_index::p).norm(), 1e-3);
  EXPECT_LT(std::abs(left[mount_index::delay]), 2e-4);
  EXPECT_LT(std::abs(left[mount_index::depth]), 2e-4);
  EXPECT_LT(update.clones.covariance.trace(), 2e-5);
}

TEST(JointUpdate, WithoutInliersReturnsThePrior) {
  Random random(4);
  const Joint joint = random_joint(random);
  const auto update = iterated_update(
      joint.estimate, joint.clones, [](const NavState&, const CameraMount&) { return JointEquations(2); },
      FilterConfig{});
  EXPECT_EQ(update.posterior.covariance, joint.estimate.covariance);
  EXPECT_EQ(update.clones.with_state, joint.clones.with_state);
}

TEST(JointUpdate, RefusesStepsThatRaiseTheCost) {
  Random random(5);
  const Joint joint = random_joint(random);
  const Vector3d start = joint.estimate.mean.p_W;
  const auto misleading = [start](const NavState& x, const CameraMount&) {
    JointEquations sums(2);
    sums.H.block<3, 3>(ix::p, ix::p) = 1e4 * Matrix3d::Identity();
    sums.b.segment<3>(ix::p) = 1e4 * Vector3d(0.1, 0.0, 0.0);  // points away from its own minimum
    sums.cost = 1e4 * (x.p_W - start).squaredNorm() + 1.0;
    sums.inliers = sums.candidates = 3;
    return sums;
  };
  const auto update = iterated_update(joint.estimate, joint.clones, misleading, FilterConfig{});
  EXPECT_EQ(update.posterior.mean.p_W, start);
}

TEST(StateUpdate, TellsWhatBecameOfThePriorsError) {
  // The truth is moved about the prior; the sensor measures it. What is left of that error afterwards is the Jacobian.
  Random random(6);
  const Estimate prior{.mean = random.state(), .covariance = random.covariance(0.1)};
  const auto left_of = [&](const Vector18& error, Matrix18* J) {
    const NavState truth = boxplus(prior.mean, error);
    const auto sensor = [&](const NavState& x) {
      NormalEquations sums;
      Vector6 r;
      r << log_so3(truth.R_W_I.inverse() * x.R_W_I), x.p_W - truth.p_W;
      Matrix6 J_r_error = Matrix6::Identity();
      J_r_error.topLeftCorner<3, 3>() = right_jacobian_inverse(r.head<3>());
      sums.H.topLeftCorner<6, 6>() = 50.0 * J_r_error.transpose() * J_r_error;
      sums.b.head<6>() = -50.0 * J_r_error.transpose() * r;
      sums.inliers = 6;
      return sums;
    };
    const auto update = iterated_update(prior, sensor, {.max_iterations = 30, .rotation_tolerance_rad = 1e-13});
    if (J) *J = update.J_posterior_prior;
    return boxminus(truth, update.posterior.mean);
  };
  Matrix18 J;
  left_of(Vector18::Zero(), &J);
  constexpr double step = 1e-4;
  for (int i = 0; i < ix::size; ++i) {
    const Vector18 slope =
        (left_of(step * Vector18::Unit(i), nullptr) - left_of(-step * Vector18::Unit(i), nullptr)) / (2.0 * step);
    EXPECT_LT((slope - J.col(i)).norm(), 1e-5) << i;
  }
}

}  // namespace
}  // namespace pllit
