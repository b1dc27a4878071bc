#include "pllit/state/clones.hpp"

#include <Eigen/LU>
#include <algorithm>
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

/// Errors from `begin` on, three of them, moved to another tangent space of the manifold.
void turn(MatrixXd& joint, Index begin, const Matrix3d& J_new_old) {
  joint.middleRows<3>(begin) = (J_new_old * joint.middleRows<3>(begin)).eval();
  joint.middleCols<3>(begin) = (joint.middleCols<3>(begin) * J_new_old.transpose()).eval();
}

/// Covariance after a gain K = `gain` H' R^-1 of the first rows (Joseph's form).
MatrixXd after_gain(const MatrixXd& prior, const MatrixXd& gain, const MatrixXd& H) {
  const MatrixXd gain_H = gain * H;
  MatrixXd kept = MatrixXd::Identity(prior.rows(), prior.cols());
  kept.topRows(gain.rows()) -= gain_H;
  MatrixXd posterior = kept * prior * kept.transpose();
  posterior.topLeftCorner(gain.rows(), gain.rows()) += gain_H * gain.transpose();
  return posterior;
}

/// State and mount together, as one point on their manifold.
struct Unknowns {
  static constexpr Index kSize = ix::size + mount_index::size;
  NavState state;
  CameraMount mount;

  void move(const VectorXd& step) {
    state = boxplus(state, step.head<ix::size>());
    mount = boxplus(mount, step.segment<mount_index::size>(joint_index::mount));
  }
  /// Errors by which this is away from `other`.
  Eigen::Matrix<double, kSize, 1> minus(const Unknowns& other) const {
    Eigen::Matrix<double, kSize, 1> d;
    d << boxminus(state, other.state), boxminus(mount, other.mount);
    return d;
  }
};

/// Where the three errors of each rotation begin, each followed by its pose's shift.
constexpr Index kTurns[] = {ix::theta, joint_index::mount + mount_index::theta};

}  // namespace

Clones without_poses(const CameraMount& mount, const MountMatrix& covariance) {
  return {.mount = mount, .poses = {}, .covariance = covariance};
}

void add_clone(Clones& clones, const Estimate& estimate, const Exposure& exposed) {
  constexpr int kMoves = 9;  // of the state's errors, those that the pose depends on
  const Index n = clones.covariance.rows();
  // What the pose's error shares with the state's, the mount's and the older poses'.
  const MatrixXd joint = joint_covariance(estimate, clones);
  const MatrixXd with_joint =
      exposed.J_state * joint.topRows<kMoves>() + exposed.J_delay * joint.row(ix::size + mount_index::delay);
  const Matrix6 own = with_joint.leftCols<kMoves>() * exposed.J_state.transpose() +
                      with_joint.col(ix::size + mount_index::delay) * exposed.J_delay.transpose();
  clones.poses.push_back(exposed.T_W_I);
  clones.covariance.conservativeResize(n + kPose, n + kPose);
  clones.covariance.bottomLeftCorner(kPose, n) = with_joint.rightCols(n);
  clones.covariance.topRightCorner(n, kPose) = with_joint.rightCols(n).transpose();
  clones.covariance.bottomRightCorner<kPose, kPose>() = own;
  clones.with_state.conservativeResize(Eigen::NoChange, n + kPose);
  clones.with_state.rightCols<kPose>() = with_joint.leftCols<ix::size>().transpose();
}

void remove_clone(Clones& clones, std::size_t index) {
  assert(index < clones.size());
  const Index begin = joint_index::clone(index) - ix::size;
  clones.poses.erase(clones.poses.begin() + static_cast<std::ptrdiff_t>(index));
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
  const Unknowns before{prior.mean, clones.mount};
  Unknowns x = before;
  MatrixXd joint = joint_prior;
  while (result.iterations < config.max_iterations && !result.converged) {
    result.last = linearize(x.state, x.mount);
    if (result.iterations++ == 0) result.first = result.last;
    if (result.last.inliers == 0)
      return {.posterior = prior, .clones = clones, .first = result.first, .last = result.last};

    VectorXd d = VectorXd::Zero(joint_prior.rows());  // the clones do not move
    d.head<Unknowns::kSize>() = x.minus(before);
    MatrixXd P = joint_prior;
    for (const Index begin : kTurns) {
      const Matrix3d J = right_jacobian(d.segment<3>(begin));
      d.segment<3>(begin) = (J * d.segment<3>(begin)).eval();
      turn(P, begin, J);
    }
    // (P^-1 + H) dx = b - P^-1 d, multiplied by P from the left so that P need not be inverted.
    const Eigen::PartialPivLU<MatrixXd> system(MatrixXd::Identity(P.rows(), P.cols()) + P * result.last.H);
    const VectorXd step = system.solve(P * result.last.b - d);
    const MatrixXd gain = system.solve(P).topRows<Unknowns::kSize>();
    joint = after_gain(P, gain, result.last.H);
    x.move(step);
    for (const Index begin : kTurns) turn(joint, begin, right_jacobian(step.segment<3>(begin)));
    result.converged = std::ranges::all_of(kTurns, [&](Index begin) {
      return step.segment<3>(begin).norm() < config.rotation_tolerance_rad &&
             step.segment<3>(begin + 3).norm() < config.position_tolerance_m;
    });
  }
  if (linearize(x.state, x.mount).cost > result.first.cost)
    return {.posterior = prior, .clones = clones, .first = result.first, .last = result.last};
  joint = 0.5 * (joint + joint.transpose()).eval();
  result.posterior = {.mean = x.state, .covariance = joint.topLeftCorner<ix::size, ix::size>()};
  result.clones.mount = x.mount;
  result.clones.with_state = joint.topRightCorner(ix::size, joint.cols() - ix::size);
  result.clones.covariance = joint.bottomRightCorner(joint.rows() - ix::size, joint.cols() - ix::size);
  return result;
}

}  // namespace pllit
