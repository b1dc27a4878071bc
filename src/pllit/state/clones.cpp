#include "pllit/state/clones.hpp"

#include <Eigen/LU>
#include <cassert>

namespace pllit {

namespace ix = error_index;

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kPose = ix::pose_size;

/// Rows and columns of a square or wide matrix without six columns (and rows).
MatrixXd without_columns(const MatrixXd& m, Index begin) {
  MatrixXd kept(m.rows(), m.cols() - kPose);
  kept << m.leftCols(begin), m.rightCols(m.cols() - begin - kPose);
  return kept;
}

/// Errors of the state moved to another tangent space of the manifold; those of the poses stay.
void turn(MatrixXd& joint, const Matrix3d& J_new_old) {
  joint.topRows<3>() = (J_new_old * joint.topRows<3>()).eval();
  joint.leftCols<3>() = (joint.leftCols<3>() * J_new_old.transpose()).eval();
}

/// Covariance after a gain that only the state gets (Joseph's form). `optimal` is the covariance after the full gain.
MatrixXd after_state_gain(const MatrixXd& prior, const MatrixXd& optimal, const MatrixXd& H) {
  const MatrixXd gain = (optimal * H).topRows<ix::size>();  // K J of the state
  MatrixXd kept = MatrixXd::Identity(prior.rows(), prior.cols());
  kept.topRows<ix::size>() -= gain;
  MatrixXd posterior = kept * prior * kept.transpose();
  posterior.topLeftCorner<ix::size, ix::size>() += gain * optimal.leftCols<ix::size>();
  return posterior;
}

}  // namespace

void add_clone(Clones& clones, const Estimate& estimate) {
  const Index n = clones.covariance.rows();
  const MatrixXd with_old = clones.with_state.topRows<kPose>();
  clones.T_W_I.push_back(estimate.mean.T_W_I());
  clones.covariance.conservativeResize(n + kPose, n + kPose);
  clones.covariance.bottomLeftCorner(kPose, n) = with_old;
  clones.covariance.topRightCorner(n, kPose) = with_old.transpose();
  clones.covariance.bottomRightCorner<kPose, kPose>() = estimate.covariance.topLeftCorner<kPose, kPose>();
  clones.with_state.conservativeResize(Eigen::NoChange, n + kPose);
  clones.with_state.rightCols<kPose>() = estimate.covariance.leftCols<kPose>();
}

void remove_clone(Clones& clones, std::size_t index) {
  assert(index < clones.size());
  const Index begin = kPose * static_cast<Index>(index);
  clones.T_W_I.erase(clones.T_W_I.begin() + static_cast<std::ptrdiff_t>(index));
  clones.with_state = without_columns(clones.with_state, begin);
  clones.covariance = without_columns(without_columns(clones.covariance, begin).transpose(), begin).transpose();
}

void carry(Clones& clones, const Matrix18& J_now_before) {
  clones.with_state = (J_now_before * clones.with_state).eval();
}

MatrixXd joint_covariance(const Estimate& estimate, const Clones& clones) {
  const Index n = clones.covariance.rows();
  MatrixXd joint(ix::size + n, ix::size + n);
  joint << estimate.covariance, clones.with_state, clones.with_state.transpose(), clones.covariance;
  return joint;
}

JointUpdate iterated_update(const Estimate& prior, const Clones& clones, const LinearizeJoint& linearize,
                            const FilterConfig& config) {
  JointUpdate result{.posterior = prior, .clones = clones};
  const MatrixXd joint_prior = joint_covariance(prior, clones);
  NavState x = prior.mean;
  MatrixXd joint = joint_prior;
  while (result.iterations < config.max_iterations && !result.converged) {
    result.last = linearize(x);
    if (result.iterations++ == 0) result.first = result.last;
    if (result.last.inliers == 0) return {.posterior = prior, .clones = clones, .first = result.first, .last = result.last};

    VectorXd d = VectorXd::Zero(joint.rows());
    d.head<ix::size>() = boxminus(x, prior.mean);
    const Matrix3d J = right_jacobian(d.head<3>());
    d.head<3>() = (J * d.head<3>()).eval();
    MatrixXd P = joint_prior;
    turn(P, J);
    // (P^-1 + H) dx = b - P^-1 d, multiplied by P from the left so that P need not be inverted.
    const Eigen::PartialPivLU<MatrixXd> system(MatrixXd::Identity(P.rows(), P.cols()) + P * result.last.H);
    const Vector18 step = system.solve(P * result.last.b - d).head<ix::size>();
    joint = after_state_gain(P, system.solve(P), result.last.H);
    x = boxplus(x, step);
    turn(joint, right_jacobian(step.segment<3>(ix::theta)));
    result.converged = step.segment<3>(ix::theta).norm() < config.rotation_tolerance_rad &&
                       step.segment<3>(ix::p).norm() < config.position_tolerance_m;
  }
  if (linearize(x).cost > result.first.cost)
    return {.posterior = prior, .clones = clones, .first = result.first, .last = result.last};
  joint = 0.5 * (joint + joint.transpose()).eval();
  result.posterior = {.mean = x, .covariance = joint.topLeftCorner<ix::size, ix::size>()};
  result.clones.with_state = joint.topRightCorner(ix::size, joint.cols() - ix::size);
  return result;
}

}  // namespace pllit
