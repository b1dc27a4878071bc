#include "pllit/thermal/prediction.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace pllit {
namespace {

using Eigen::Vector2f;

std::optional<Prediction> predict(const Vector3d& ray_K, const std::optional<FeatureDepth>& depth, const SE3& T_C_K,
                                  const Camera& camera, double nearest_m) {
  const Vector3d p_C = T_C_K.translation(), direction_C = T_C_K.rotation() * ray_K;
  if (depth) {
    const auto pixel = camera.project(p_C + depth->range_m * direction_C);
    if (!pixel) return std::nullopt;
    return Prediction{pixel->cast<float>(), pixel->cast<float>()};
  }
  const auto far = camera.project(direction_C);
  if (!far) return std::nullopt;
  constexpr int kDoublings = 8;
  for (int i = 0; i < kDoublings; ++i, nearest_m *= 2.0)
    if (const auto near = camera.project(p_C + nearest_m * direction_C); near && (*near - *far).norm() < camera.width)
      return Prediction{far->cast<float>(), near->cast<float>()};
  return Prediction{far->cast<float>(), far->cast<float>()};
}

struct Sight {
  Vector3d p_K;
  Eigen::Vector2d seen_px;
};

std::vector<Sight> sights_of(const Keyframe& keyframe, std::span<const Vector3d> rays_K,
                             std::span<const PointMatch> matches, const Features& now) {
  std::vector<Sight> sights;
  for (const PointMatch& match : matches) {
    const auto i = static_cast<std::size_t>(match.reference);
    if (keyframe.depths[i])
      sights.push_back({keyframe.depths[i]->range_m * rays_K[i],
                        now.points_px[static_cast<std::size_t>(match.current)].cast<double>()});
  }
  return sights;
}

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// One step over the turn and shift of the camera's frame, at weights for a width of the loss. The projection's
/// Jacobian is the pinhole's: steps need not be exact.
SE3 improved(const SE3& T_C_K, const SE3& prior, const std::vector<Sight>& sights, const Camera& camera,
             double width_px) {
  constexpr double kTurn_rad = 0.02, kShift_m = 0.1;  // prior, sigma
  Vector6 weights;
  weights << Vector3d::Constant(1.0 / (kTurn_rad * kTurn_rad)), Vector3d::Constant(1.0 / (kShift_m * kShift_m));
  const SE3 gone = T_C_K * prior.inverse();
  Vector6 from_prior;
  from_prior << log_so3(gone.asSO3()), gone.translation();
  Matrix6 A = weights.asDiagonal();
  Vector6 b = -weights.cwiseProduct(from_prior);
  for (const Sight& sight : sights) {
    const Vector3d p_C = T_C_K.act(sight.p_K);
    const auto pixel = camera.project(p_C);
    if (!pixel) continue;
    const Eigen::Vector2d r = sight.seen_px - *pixel;
    const double u = r.norm() / width_px;
    if (u >= 1.0) continue;
    const double w = (1.0 - u * u) * (1.0 - u * u);
    Eigen::Matrix<double, 2, 3> J_px_p;
    J_px_p << camera.fx / p_C.z(), 0.0, -camera.fx * p_C.x() / (p_C.z() * p_C.z()), 0.0, camera.fy / p_C.z(),
        -camera.fy * p_C.y() / (p_C.z() * p_C.z());
    Eigen::Matrix<double, 3, 6> J_p_pose;
    J_p_pose << -skew(p_C), Matrix3d::Identity();
    const Eigen::Matrix<double, 2, 6> J = J_px_p * J_p_pose;
    A += w * J.transpose() * J;
    b += w * J.transpose() * r;
  }
  const Vector6 step = A.ldlt().solve(b);
  return pose_from(exp_so3(step.head<3>()), step.tail<3>()) * T_C_K;
}

}  // namespace

Vector2f Prediction::off(const Vector2f& at) const {
  const Vector2f along = near_px - far_px;
  const float length2 = along.squaredNorm();
  const float s = length2 > 0.0F ? std::clamp(along.dot(at - far_px) / length2, 0.0F, 1.0F) : 0.0F;
  return at - far_px - s * along;
}

std::vector<Vector3d> rays_of(const Keyframe& keyframe, const Camera& camera) {
  std::vector<Vector3d> rays_K;
  rays_K.reserve(keyframe.features.points_px.size());
  for (const Vector2f& point : keyframe.features.points_px) rays_K.push_back(camera.ray(point.cast<double>()));
  return rays_K;
}

std::vector<std::optional<Prediction>> predictions_of(const Keyframe& keyframe, std::span<const Vector3d> rays_K,
                                                      const SE3& T_C_K, const Camera& camera, double nearest_m) {
  assert(keyframe.depths.size() == rays_K.size());
  std::vector<std::optional<Prediction>> predictions;
  predictions.reserve(rays_K.size());
  for (std::size_t i = 0; i < rays_K.size(); ++i)
    predictions.push_back(predict(rays_K[i], keyframe.depths[i], T_C_K, camera, nearest_m));
  return predictions;
}

SE3 agreed_pose(const Keyframe& keyframe, std::span<const Vector3d> rays_K, std::span<const PointMatch> matches,
                const Features& now, const SE3& T_C_K, const Camera& camera) {
  constexpr std::size_t kEnough = 10;
  constexpr std::array kWidths_px{24.0, 16.0, 10.0, 6.0, 4.0, 4.0};
  const std::vector<Sight> sights = sights_of(keyframe, rays_K, matches, now);
  if (sights.size() < kEnough) return T_C_K;
  SE3 agreed = T_C_K;
  for (const double width_px : kWidths_px) agreed = improved(agreed, T_C_K, sights, camera, width_px);
  return agreed;
}

}  // namespace pllit
