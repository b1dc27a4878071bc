#include "pllit/thermal/visual_residuals.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>

#include "pllit/thermal/reprojection.hpp"

namespace pllit {

namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

/// Cauchy's loss of a residual of squared Mahalanobis length `squared`.
struct Loss {
  double weight, cost;
};
Loss cauchy(double squared, double k) {
  const double k2 = k * k;
  return {k2 / (k2 + squared), k2 * std::log1p(squared / k2)};
}

/// Mean of weight x squared for a residual of two normal numbers: squared / 2 is exponentially distributed.
double mean_weighted_square(double k) {
  const double a = 0.5 * k * k;
  const double mean_weight = -a * std::exp(a) * std::expint(-a);
  return 2.0 * a * (1.0 - mean_weight);
}

/// Adds residuals to the joint equations.
class Sums {
 public:
  Sums(const Exposure& exposed, std::size_t keyframes, const VisualConfig& config, const MatrixXd& search_covariance)
      : exposed_(exposed), equations_(keyframes), config_(config), search_(search_covariance) {
    assert(search_.size() == 0 || search_.rows() == equations_.b.size());
  }

  void add(const ImageResidual& residual, double sigma_px, std::size_t keyframe) {
    ++equations_.candidates;
    const Blocks blocks = blocks_of(residual, keyframe);
    const Matrix2d noise = sigma_px * sigma_px * Matrix2d::Identity() + residual.model_px2;
    const Matrix2d information = noise.inverse();
    const double squared = residual.r_px.dot(information * residual.r_px);
    const double beyond =
        search_.size() == 0 ? squared : residual.r_px.dot((noise + searched(blocks)).inverse() * residual.r_px);
    if (const double gate2 = config_.gate * config_.gate; beyond > gate2) {
      equations_.cost += cauchy(squared * gate2 / beyond, config_.loss).cost;
      return;
    }
    ++equations_.inliers;
    points_worth_ += 0.5 * config_.point_sigma_px * config_.point_sigma_px * information.trace();
    const Eigen::Matrix<double, 2, 3> J_shift = residual.J_now.rightCols<3>();
    shift_information_ += 0.5 * (J_shift.transpose() * information * J_shift).trace();
    const Loss loss = cauchy(squared, config_.loss);
    equations_.cost += loss.cost;
    equations_.squared += loss.weight * squared;
    add_blocks(blocks, loss.weight * information, residual.r_px);
  }

  /// A match that cannot be right: as if beyond the gate.
  void reject() {
    ++equations_.candidates;
    equations_.cost += cauchy(config_.gate * config_.gate, config_.loss).cost;
  }

  JointEquations capped() && {
    JointEquations& sums = equations_;
    sums.expected = sums.inliers * mean_weighted_square(config_.loss);
    // Errors of calibration and timing are common to all of an image, in pixels, and so are those of depths, in metres:
    // together its points may claim only so much.
    double share = 1.0;
    if (config_.max_information > 0.0) share = std::min(share, config_.max_information / points_worth_);
    if (config_.common_shift_m > 0.0)
      share = std::min(share, 1.0 / (config_.common_shift_m * config_.common_shift_m * shift_information_));
    if (share < 1.0) {
      sums.H *= share;
      sums.b *= share;
      sums.cost *= share;
      sums.squared *= share;
      sums.expected *= share;
      sums.share = share;
    }
    return std::move(sums);
  }

 private:
  /// Derivative of one residual to some of the errors, and where those begin.
  struct Block {
    Index at = 0;
    Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 9> J;
  };
  using Blocks = std::array<Block, 3>;

  Blocks blocks_of(const ImageResidual& residual, std::size_t keyframe) const {
    Eigen::Matrix<double, 2, mount_index::size> J_mount;
    J_mount << residual.J_camera, residual.J_now * exposed_.J_delay, residual.J_depth;
    return {{{0, residual.J_now * exposed_.J_state},
             {joint_index::mount, J_mount},
             {joint_index::clone(keyframe), residual.J_keyframe}}};
  }

  /// Covariance in the image of what the prediction leaves open.
  Matrix2d searched(const Blocks& blocks) const {
    Matrix2d sum = Matrix2d::Zero();
    for (const Block& a : blocks)
      for (const Block& b : blocks) sum += a.J * search_.block(a.at, b.at, a.J.cols(), b.J.cols()) * b.J.transpose();
    return sum;
  }

  void add_blocks(const Blocks& blocks, const Matrix2d& W, const Vector2d& r_px) {
    for (const Block& a : blocks) {
      const Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, 9, 2> JW = a.J.transpose() * W;
      equations_.b.segment(a.at, a.J.cols()).noalias() -= JW * r_px;
      for (const Block& b : blocks) equations_.H.block(a.at, b.at, a.J.cols(), b.J.cols()).noalias() += JW * b.J;
    }
  }

  const Exposure& exposed_;
  JointEquations equations_;
  double points_worth_ = 0.0;       ///< how many points of no other noise than the detector's say as much
  double shift_information_ = 0.0;  ///< on a shift, the mean of two directions, 1/m2
  const VisualConfig& config_;
  const MatrixXd& search_;
};

}  // namespace

std::vector<double> adaptive_weights(std::span<const PointObservation> points, const VisualConfig& config) {
  std::vector<double> weights(points.size(), 1.0);
  if (!config.weights || points.empty()) return weights;
  double squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = points[i].line_px / config.weight_sigma_px;
    if (points[i].line_px >= 0.0) weights[i] = config.weight_gain * (1.0 + std::exp(-distance * distance));
    squares += weights[i] * weights[i];
  }
  const double scale = std::sqrt(static_cast<double>(points.size()) / squares);
  for (double& weight : weights) weight *= scale;
  return weights;
}

std::vector<LineObservation> nearest_of_each(std::span<const LineObservation> lines, const SE3& T_W_I,
                                             std::span<const SE3> T_W_I_keyframes, const SE3& T_I_C,
                                             const Camera& camera) {
  std::map<std::uint32_t, std::pair<double, const LineObservation*>> nearest;  // in order of their ids
  for (const LineObservation& line : lines) {
    const auto seen = line_residual(T_W_I, T_W_I_keyframes[line.keyframe], line, T_I_C, camera);
    if (!seen) continue;
    const double off_px = seen->residual.r_px.norm();
    const auto [at, first] = nearest.try_emplace(line.line_K.id, off_px, &line);
    if (!first && off_px < at->second.first) at->second = {off_px, &line};
  }
  std::vector<LineObservation> kept;
  for (const auto& [id, best] : nearest) kept.push_back(*best.second);
  return kept;
}

JointEquations linearize_image(const NavState& state, const CameraMount& mount, std::span<const SE3> T_W_I_keyframes,
                               const ImageObservations& observations, const Camera& camera, const VisualConfig& config,
                               const MatrixXd& search_covariance) {
  const Exposure exposed = exposure(state, mount.delay_s, observations.rate_I);
  Sums sums(exposed, T_W_I_keyframes.size(), config, search_covariance);
  const std::vector<double> weights = adaptive_weights(observations.points, config);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const PointObservation& point = observations.points[i];
    assert(point.keyframe < T_W_I_keyframes.size());
    if (const auto residual = point_residual(exposed.T_W_I, T_W_I_keyframes[point.keyframe], point, mount, camera))
      sums.add(*residual, point.sigma_px / weights[i], point.keyframe);
    else
      sums.reject();
  }
  if (!config.lines) return std::move(sums).capped();
  const double most_turn = std::sin(config.line_turn_deg * M_PI / 180.0);
  for (const LineObservation& line : observations.lines) {
    const auto seen = line_residual(exposed.T_W_I, T_W_I_keyframes[line.keyframe], line, mount.T_I_C, camera);
    if (seen && seen->sin_plane > config.line_plane && seen->sin_turn < most_turn)
      sums.add(seen->residual, config.line_sigma_px, line.keyframe);
    else
      sums.reject();
  }
  return std::move(sums).capped();
}

Matrix6 keyframe_noise(std::span<const Vector3d> points_K, const SE3& T_I_C, const Camera& camera, double sigma_px) {
  // What few points or a poor spread of them leave open stays within a pose that nobody would take for a keyframe's.
  constexpr double most_turn_rad = 0.01, most_shift_m = 0.1;
  Vector6 least;
  least << Vector3d::Constant(1.0 / (most_turn_rad * most_turn_rad)),
      Vector3d::Constant(1.0 / (most_shift_m * most_shift_m));
  Matrix6 information = least.asDiagonal();
  for (const Vector3d& p_K : points_K) {
    const PointObservation itself{.p_K_m = p_K, .observed_px = Vector2d::Zero()};
    if (const auto residual = point_residual(SE3::Identity(), SE3::Identity(), itself, {.T_I_C = T_I_C}, camera))
      information.noalias() += residual->J_keyframe.transpose() * residual->J_keyframe / (sigma_px * sigma_px);
  }
  return information.ldlt().solve(Matrix6::Identity());
}

}  // namespace pllit
