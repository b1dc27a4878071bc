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

/// The part of the state's rows that lies along the directions.
void keep_along(const std::optional<StateDirections>& along, MatrixXd& rows) {
  if (along) rows.topRows<ix::size>() = (*along * (along->transpose() * rows.topRows<ix::size>())).eval();
}

/// The state and the unknown poses together, as one point on their manifold.
struct Unknowns {
  NavState state;
  std::vector<SE3> poses;  ///< all, of which the first `estimated` move
  std::size_t estimated;

  static Index begin_of(std::size_t pose) { return ix::size + kPose * static_cast<Index>(pose); }
  Index size() const { return begin_of(estimated); }

  void move(const VectorXd& step) {
    state = boxplus(state, step.head<ix::size>());
    for (std::size_t i = 0; i < estimated; ++i)
      poses[i] = pose_from(poses[i].asSO3() * exp_so3(step.segment<3>(begin_of(i))),
                           poses[i].translation() + step.segment<3>(begin_of(i) + 3));
  }
  /// Errors by which this is away from `other`, zero for the poses that do not move.
  VectorXd minus(const Unknowns& other) const {
    VectorXd d = VectorXd::Zero(begin_of(poses.size()));
    d.head<ix::size>() = boxminus(state, other.state);
    for (std::size_t i = 0; i < estimated; ++i) {
      d.segment<3>(begin_of(i)) = log_so3(other.poses[i].asSO3().inverse() * poses[i].asSO3());
      d.segment<3>(begin_of(i) + 3) = poses[i].translation() - other.poses[i].translation();
    }
    return d;
  }
  /// Where the three errors of each moving rotation begin.
  std::vector<Index> turns() const {
    std::vector<Index> begins{ix::theta};
    for (std::size_t i = 0; i < estimated; ++i) begins.push_back(begin_of(i));
    return begins;
  }
};

}  // namespace

Clones with_unknown(const SE3& pose, const Matrix6& covariance) {
  return {.poses = {pose}, .with_state = MatrixXd::Zero(ix::size, kPose), .covariance = covariance, .estimated = 1};
}

void add_clone(Clones& clones, const Estimate& estimate) {
  const Index n = clones.covariance.rows();
  const MatrixXd with_old = clones.with_state.topRows<kPose>();
  clones.poses.push_back(estimate.mean.T_W_I());
  clones.covariance.conservativeResize(n + kPose, n + kPose);
  clones.covariance.bottomLeftCorner(kPose, n) = with_old;
  clones.covariance.topRightCorner(n, kPose) = with_old.transpose();
  clones.covariance.bottomRightCorner<kPose, kPose>() = estimate.covariance.topLeftCorner<kPose, kPose>();
  clones.with_state.conservativeResize(Eigen::NoChange, n + kPose);
  clones.with_state.rightCols<kPose>() = estimate.covariance.leftCols<kPose>();
}

void remove_clone(Clones& clones, std::size_t index) {
  assert(index >= clones.estimated && index < clones.size());
  const Index begin = kPose * static_cast<Index>(index);
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
                            const FilterConfig& config, const std::optional<StateDirections>& along) {
  JointUpdate result{.posterior = prior, .clones = clones};
  const MatrixXd joint_prior = joint_covariance(prior, clones);
  const Unknowns before{prior.mean, clones.poses, clones.estimated};
  Unknowns x = before;
  MatrixXd joint = joint_prior;
  while (result.iterations < config.max_iterations && !result.converged) {
    result.last = linearize(x.state, x.poses);
    if (result.iterations++ == 0) result.first = result.last;
    if (result.last.inliers == 0)
      return {.posterior = prior, .clones = clones, .first = result.first, .last = result.last};

    VectorXd d = x.minus(before);
    MatrixXd P = joint_prior;
    for (const Index begin : x.turns()) {
      const Matrix3d J = right_jacobian(d.segment<3>(begin));
      d.segment<3>(begin) = (J * d.segment<3>(begin)).eval();
      turn(P, begin, J);
    }
    // (P^-1 + H) dx = b - P^-1 d, multiplied by P from the left so that P need not be inverted.
    const Eigen::PartialPivLU<MatrixXd> system(MatrixXd::Identity(P.rows(), P.cols()) + P * result.last.H);
    MatrixXd moved = system.solve(P * result.last.b - d) + d, gain = system.solve(P).topRows(x.size());
    keep_along(along, moved);
    keep_along(along, gain);
    const VectorXd step = moved.col(0) - d;
    joint = after_gain(P, gain, result.last.H);
    x.move(step);
    for (const Index begin : x.turns()) turn(joint, begin, right_jacobian(step.segment<3>(begin)));
    result.converged = std::ranges::all_of(x.turns(), [&](Index begin) {  // each followed by its pose's shift
      return step.segment<3>(begin).norm() < config.rotation_tolerance_rad &&
             step.segment<3>(begin + 3).norm() < config.position_tolerance_m;
    });
  }
  if (linearize(x.state, x.poses).cost > result.first.cost)
    return {.posterior = prior, .clones = clones, .first = result.first, .last = result.last};
  joint = 0.5 * (joint + joint.transpose()).eval();
  result.posterior = {.mean = x.state, .covariance = joint.topLeftCorner<ix::size, ix::size>()};
  result.clones.poses = std::move(x.poses);
  result.clones.with_state = joint.topRightCorner(ix::size, joint.cols() - ix::size);
  result.clones.covariance = joint.bottomRightCorner(joint.rows() - ix::size, joint.cols() - ix::size);
  return result;
}

}  // namespace pllit
