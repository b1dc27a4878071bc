#include "pllit/slam/drift.hpp"

#include <Eigen/Eigenvalues>

namespace pllit {
namespace {

constexpr double kAxis_rad = 0.005;  // an unobserved direction is found from planes: it leans a little into the others

/// The nearest covariance: what would be negative along some direction is nothing.
Matrix3d positive_part(const Matrix3d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(symmetric);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

Matrix6 PoseDoubt::total() const {
  Matrix6 sum = match + drift;
  sum.bottomRightCorner<3, 3>() += reckoned;
  return sum;
}

Matrix6 relative_covariance(const PoseDoubt& a, const PoseDoubt& b, const Vector3d& displacement_W) {
  Matrix6 sum = b.drift - carried(a.drift, displacement_W) + b.match + carried(a.match, displacement_W);
  // What was reckoned before a is common to both.
  sum.bottomRightCorner<3, 3>() += positive_part(b.reckoned - a.reckoned);
  return sum;
}

Matrix6 carried(const Matrix6& covariance_W, const Vector3d& displacement_W) {
  Matrix6 F = Matrix6::Identity();
  F.bottomLeftCorner<3, 3>() = -skew(displacement_W);
  return F * covariance_W * F.transpose();
}

Matrix6 pose_covariance_W(const Estimate& estimate) {
  Matrix6 to_W = Matrix6::Identity();
  to_W.topLeftCorner<3, 3>() = estimate.mean.R_W_I.rotation();
  return to_W * estimate.covariance.topLeftCorner<6, 6>() * to_W.transpose();
}

void MapDrift::move_to(const Vector3d& p_W) {
  doubt_.drift = carried(doubt_.drift, p_W - p_W_);
  const double way_m = (p_W - p_W_).norm();
  doubt_.drift.diagonal().head<3>().array() += config_.turn_rad * config_.turn_rad * way_m;
  doubt_.drift.diagonal().tail<3>().array() += config_.shift_m * config_.shift_m * way_m;
  p_W_ = p_W;
}

void MapDrift::place(const Estimate& posterior, const Eigen::Matrix3Xd& unobserved, bool image_holds) {
  const Matrix6 P = pose_covariance_W(posterior);
  const Matrix3d shift = P.bottomRightCorner<3, 3>(), reckoned = unobserved * unobserved.transpose(),
                 placed = Matrix3d::Identity() - reckoned;
  Matrix6 observed = Matrix6::Identity();
  observed.bottomRightCorner<3, 3>() = placed;
  doubt_.match = observed * P * observed;

  const Matrix3d inherited = positive_part(placed * (not_inherited_ - shift) * placed);
  doubt_.drift.bottomRightCorner<3, 3>() += inherited;
  const double factor = image_holds ? 1.0 : config_.imu_factor;
  const Matrix3d along = factor * factor * reckoned * shift * reckoned;
  doubt_.reckoned = along + kAxis_rad * kAxis_rad * along.trace() * placed;
  not_inherited_ = along + positive_part(placed * not_inherited_ * placed - inherited);
}

void MapDrift::add_scan(double new_share) { doubt_.drift += config_.gain * new_share * new_share * doubt_.match; }

void MapDrift::restart(const Estimate& estimate) {
  doubt_.drift += pose_covariance_W(estimate);
  doubt_.match.setZero();
  doubt_.reckoned = not_inherited_ = Matrix3d::Zero();
}

}  // namespace pllit
