#include "pllit/eval/align.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <format>

namespace pllit {
namespace {

constexpr double kDegenerateRatio = 1e-12;  // of variances: a line whose width is a millionth of its length
constexpr double kLeastVariance_m2 = 1e-12;

/// Mean positions and the covariance sum_i (w_i - w)(v_i - v)' / n of Umeyama's equations 34, 35 and 38.
struct Moments {
  Vector3d mean_W = Vector3d::Zero(), mean_V = Vector3d::Zero();
  Matrix3d covariance_W_V = Matrix3d::Zero();
};

Moments moments_of(std::span<const PosePair> pairs) {
  Moments moments;
  const auto n = static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    moments.mean_W += pair.T_W_I.translation() / n;
    moments.mean_V += pair.T_V_I.translation() / n;
  }
  for (const PosePair& pair : pairs)
    moments.covariance_W_V +=
        (pair.T_W_I.translation() - moments.mean_W) * (pair.T_V_I.translation() - moments.mean_V).transpose() / n;
  return moments;
}

/// Rotation that maximises trace(R' covariance): equations 40 and 43.
Expected<Matrix3d> full_rotation(const Moments& moments, std::size_t poses) {
  const Eigen::JacobiSVD<Matrix3d> svd(moments.covariance_W_V, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector3d d = svd.singularValues();
  if (poses < 3 || d[0] < kLeastVariance_m2 || d[1] < kDegenerateRatio * d[0])
    return input_error(
        std::format("{} matched positions lie on one line or at one point, which leaves the rotation open; "
                    "align with yaw or none",
                    poses));
  Vector3d sign(1.0, 1.0, 1.0);
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign[2] = -1.0;  // a reflection would fit better
  return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}

/// The same among rotations about z: the trace is c (C_xx + C_yy) + s (C_yx - C_xy) plus a constant.
Expected<Matrix3d> yaw_rotation(const Moments& moments, std::size_t poses) {
  const Matrix3d& C = moments.covariance_W_V;
  const double cosine = C(0, 0) + C(1, 1), sine = C(1, 0) - C(0, 1);
  if (poses < 2 || std::hypot(cosine, sine) < kLeastVariance_m2)
    return input_error(
        std::format("{} matched positions lie above each other, which leaves the heading open; align with "
                    "none",
                    poses));
  return Eigen::AngleAxisd(std::atan2(sine, cosine), Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace

Expected<SE3> alignment_of(std::span<const PosePair> pairs, Alignment alignment) {
  if (alignment == Alignment::none) return SE3::Identity();
  const Moments moments = moments_of(pairs);
  const auto R_W_V =
      alignment == Alignment::se3 ? full_rotation(moments, pairs.size()) : yaw_rotation(moments, pairs.size());
  if (!R_W_V) return std::unexpected(R_W_V.error());
  return pose_from(rotation_from(Eigen::Quaterniond(*R_W_V)), moments.mean_W - *R_W_V * moments.mean_V);
}

std::vector<PosePair> aligned(std::span<const PosePair> pairs, const SE3& T_W_V) {
  std::vector<PosePair> moved(pairs.begin(), pairs.end());
  for (PosePair& pair : moved) pair.T_V_I = T_W_V * pair.T_V_I;
  return moved;
}

}  // namespace pllit
