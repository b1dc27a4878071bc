#include "pllit/slam/drift.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numbers>

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
  for (const Vector6& error_W : systematic) sum += error_W * error_W.transpose();
  return sum;
}

Matrix6 relative_covariance(const PoseDoubt& a, const PoseDoubt& b, const Vector3d& displacement_W) {
  Matrix6 sum = b.drift - carried(a.drift, displacement_W) + b.match + carried(a.match, displacement_W);
  // What was reckoned before a is common to both.
  sum.bottomRightCorner<3, 3>() += positive_part(b.reckoned - a.reckoned);
  for (std::size_t i = 0; i < a.systematic.size(); ++i) {
    const Vector6 between_W = b.systematic[i] - carried(a.systematic[i], displacement_W);
    sum += between_W * between_W.transpose();
  }
  return sum;
}

Matrix6 carried(const Matrix6& covariance_W, const Vector3d& displacement_W) {
  Matrix6 F = Matrix6::Identity();
  F.bottomLeftCorner<3, 3>() = -skew(displacement_W);
  return F * covariance_W * F.transpose();
}

Vector6 carried(const Vector6& error_W, const Vector3d& displacement_W) {
  Vector6 there_W = error_W;
  there_W.tail<3>() += error_W.head<3>().cross(displacement_W);
  return there_W;
}

Matrix6 pose_covariance_W(const Estimate& estimate) {
  Matrix6 to_W = Matrix6::Identity();
  to_W.topLeftCorner<3, 3>() = estimate.mean.R_W_I.rotation();
  return to_W * estimate.covariance.topLeftCorner<6, 6>() * to_W.transpose();
}

void MapDrift::move_to(const SE3& T_W_I) {
  const Vector3d displacement_W = T_W_I.translation() - T_W_I_.translation();
  doubt_.drift = carried(doubt_.drift, displacement_W);
  for (Vector6& error_W : doubt_.systematic) error_W = carried(error_W, displacement_W);
  doubt_.systematic[0].tail<3>() += config_.scale_share * displacement_W;
  turned_rad_ += log_so3(T_W_I.asSO3() * T_W_I_.asSO3().inverse()).z();
  const double way_m = displacement_W.norm();
  doubt_.drift.diagonal().head<3>().array() += config_.turn_rad * config_.turn_rad * way_m;
  doubt_.drift.diagonal().tail<3>().array() += config_.shift_m * config_.shift_m * way_m;
  T_W_I_ = T_W_I;
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

void MapDrift::add_scan(double new_share) {
  doubt_.drift += config_.gain * new_share * doubt_.match;
  const double into_the_new_rad = 2.0 * std::numbers::pi * new_share;  // where all is known a turn shows rightly
  doubt_.systematic[1].z() += config_.turn_share * std::clamp(turned_rad_, -into_the_new_rad, into_the_new_rad);
  turned_rad_ = 0.0;
}

void MapDrift::restart(const Estimate& estimate) {
  doubt_.drift += pose_covariance_W(estimate);
  doubt_.match.setZero();
  doubt_.reckoned = not_inherited_ = Matrix3d::Zero();
}

}  // namespace pllit
