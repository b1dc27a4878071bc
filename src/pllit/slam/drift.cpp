#include "pllit/slam/drift.hpp"

namespace pllit {

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
  covariance_W_ = carried(covariance_W_, p_W - p_W_);
  const double way_m = (p_W - p_W_).norm();
  covariance_W_.diagonal().head<3>().array() += config_.turn_rad * config_.turn_rad * way_m;
  covariance_W_.diagonal().tail<3>().array() += config_.shift_m * config_.shift_m * way_m;
  p_W_ = p_W;
}

void MapDrift::add_scan(const Estimate& posterior, double new_share, const Eigen::Matrix3Xd& unobserved) {
  Matrix6 observed = Matrix6::Identity();
  observed.bottomRightCorner<3, 3>() -= unobserved * unobserved.transpose();
  covariance_W_ += config_.gain * new_share * new_share * observed * pose_covariance_W(posterior) * observed;
}

void MapDrift::restart(const Estimate& estimate) { covariance_W_ += pose_covariance_W(estimate); }

}  // namespace pllit
