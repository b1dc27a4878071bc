#include "pllit/slam/keyframe_maker.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace pllit {
namespace {

namespace ix = error_index;

double turn_deg(const SE3& a, const SE3& b) { return log_so3(a.asSO3().inverse() * b.asSO3()).norm() * 180.0 / M_PI; }
double shift_m(const SE3& a, const SE3& b) { return (b.translation() - a.translation()).norm(); }

/// The covariance of the motion from a to b, perturbed on the right in b's frame. What rounds to nothing is still a
/// little.
Matrix6 step_covariance(const FrameEstimate& a, const FrameEstimate& b) {
  constexpr double least = 1e-5;  // rad, m
  Matrix6 to_b = Matrix6::Zero();
  to_b.topLeftCorner<3, 3>() = to_b.bottomRightCorner<3, 3>() = b.posterior.mean.R_W_I.rotation().transpose();
  const Matrix6 covariance = to_b * relative_pose_covariance(a, b) * to_b.transpose();
  return 0.5 * (covariance + covariance.transpose()) + least * least * Matrix6::Identity();
}

}  // namespace

std::optional<LoopKeyframe> KeyframeMaker::take(const FrameEstimate& frame) {
  const SE3 T_W_I = frame.posterior.mean.T_W_I();
  if (last_) way_m_ += (frame.posterior.mean.p_W - last_p_W_).norm();
  last_p_W_ = frame.posterior.mean.p_W;
  const bool due = !last_ || shift_m(last_->posterior.mean.T_W_I(), T_W_I) >= config_.spacing_m ||
                   turn_deg(last_->posterior.mean.T_W_I(), T_W_I) >= config_.spacing_deg;
  gather(frame);
  if (!due) return std::nullopt;
  LoopKeyframe keyframe = made_at(frame);
  last_ = frame;
  last_->cloud = {};
  points_last_.clear();
  return keyframe;
}

void KeyframeMaker::gather(const FrameEstimate& frame) {
  constexpr double enough_m = 0.4, enough_deg = 5.0;
  const SE3 T_W_I = frame.posterior.mean.T_W_I();
  if (!frame.facts.has_scan || !(frame.facts.matched || frame.facts.map_empty)) return;
  if (last_gathered_W_I_ && shift_m(*last_gathered_W_I_, T_W_I) < enough_m &&
      turn_deg(*last_gathered_W_I_, T_W_I) < enough_deg)
    return;
  last_gathered_W_I_ = T_W_I;
  const SE3 T_last_I = last_ ? last_->posterior.mean.T_W_I().inverse() * T_W_I : SE3::Identity();
  const Eigen::Matrix3f R = T_last_I.rotation().cast<float>();
  const Vector3f t = T_last_I.translation().cast<float>();
  const auto range2_m2 = static_cast<float>(config_.range_m * config_.range_m);
  std::vector<Vector3f> near;
  for (const Vector3f& p_I : frame.cloud.points_I)
    if (p_I.squaredNorm() < range2_m2) near.push_back(p_I);
  for (const Vector3f& p_I : thinned(near, config_.voxel_m)) points_last_.push_back(R * p_I + t);
}

LoopKeyframe KeyframeMaker::made_at(const FrameEstimate& frame) const {
  const NavState& state = frame.posterior.mean;
  LoopKeyframe keyframe{.time = state.time, .T_O_I = state.T_W_I(), .way_m = way_m_, .cloud = {}};
  const SE3 T_I_last = last_ ? keyframe.T_O_I.inverse() * last_->posterior.mean.T_W_I() : SE3::Identity();
  if (last_) keyframe.step_covariance = step_covariance(*last_, frame);
  keyframe.up_I = -(state.R_W_I.rotation().transpose() * state.gravity_W).normalized();
  const Matrix3d gravity_covariance = frame.posterior.covariance.block<3, 3>(ix::g, ix::g);
  keyframe.up_sigma_rad = std::sqrt(gravity_covariance.trace()) / state.gravity_W.norm();
  const Eigen::Matrix3f R = T_I_last.rotation().cast<float>();
  const Vector3f t = T_I_last.translation().cast<float>();
  std::vector<Vector3f> points_I;
  points_I.reserve(points_last_.size());
  for (const Vector3f& p : points_last_) points_I.push_back(R * p + t);
  keyframe.cloud = CompactCloud(thinned(points_I, config_.voxel_m));
  return keyframe;
}

}  // namespace pllit
