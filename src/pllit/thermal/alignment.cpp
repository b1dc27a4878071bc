#include "pllit/thermal/alignment.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace pllit {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix2f;
using Eigen::Vector2d;
using Eigen::Vector2f;

constexpr int kMostHalf_px = 8;
constexpr int kMostPixels = (2 * kMostHalf_px + 1) * (2 * kMostHalf_px + 1);
/// Pixels of a patch, row by row, in room of fixed size.
using Patch = Eigen::Array<float, Eigen::Dynamic, 1, Eigen::ColMajor, kMostPixels, 1>;

float between_pixels(const cv::Mat& image, float x, float y) {
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float a = x - static_cast<float>(x0), b = y - static_cast<float>(y0);
  const auto* up = image.ptr<std::uint8_t>(y0) + x0;
  const auto* down = image.ptr<std::uint8_t>(y0 + 1) + x0;
  return (1.0F - b) * ((1.0F - a) * up[0] + a * up[1]) + b * ((1.0F - a) * down[0] + a * down[1]);
}

bool holds(const cv::Mat& image, const Vector2f& at_px, float reach_px) {
  return at_px.x() >= reach_px && at_px.y() >= reach_px && at_px.x() < static_cast<float>(image.cols - 1) - reach_px &&
         at_px.y() < static_cast<float>(image.rows - 1) - reach_px;
}

/// Greys of the square of side 2 half_px + 1 around `at_px`, whose steps are the columns of `step`.
template <class Out>
void draw(const cv::Mat& image, const Vector2f& at_px, const Matrix2f& step, int half_px, Out& out) {
  Eigen::Index k = 0;
  for (int v = -half_px; v <= half_px; ++v)
    for (int u = -half_px; u <= half_px; ++u) {
      const Vector2f at = at_px + step * Vector2f(static_cast<float>(u), static_cast<float>(v));
      out[k++] = between_pixels(image, at.x(), at.y());
    }
}

/// How a step in the image now moves the place in the keyframe's, for a point of a plane.
std::optional<Matrix2f> step_in_keyframe(const Vector3d& p_K, const Vector3d& normal_K, const SE3& T_C_K,
                                         const Camera& camera, double most_scale) {
  const auto there = camera.project_with_slope(p_K), here = camera.project_with_slope(T_C_K.act(p_K));
  if (!there || !here) return std::nullopt;
  Matrix3d on_plane;
  on_plane << there->J_pixel_point, normal_K.transpose();
  const Matrix2d forward =
      here->J_pixel_point * T_C_K.rotation() * on_plane.inverse().leftCols<2>();  // pixel now by pixel then
  const Matrix2d step = forward.inverse();
  const double scale2 = std::abs(step.determinant());
  if (!(scale2 < most_scale * most_scale && scale2 * most_scale * most_scale > 1.0)) return std::nullopt;
  return step.cast<float>();
}

/// What the image now is compared with, and how the comparison changes with a shift of it.
struct Template {
  Vector2f thought_px = Vector2f::Zero();  ///< where the pose puts its middle
  Patch greys, along_u, along_v;           ///< without mean; slopes without what a gain or bias explains
  float squared = 0.0F;
  Matrix2f H_inverse = Matrix2f::Zero();
};

std::optional<Template> drawn_from(const cv::Mat& image, const Vector2f& at_px, const Matrix2f& step,
                                   const AlignConfig& config) {
  const int half = config.half_px, side = 2 * half + 1, wide = side + 2;
  const float reach = static_cast<float>(half + 1) * step.cwiseAbs().rowwise().sum().maxCoeff();
  if (!holds(image, at_px, reach)) return std::nullopt;
  Eigen::Array<float, (2 * kMostHalf_px + 3) * (2 * kMostHalf_px + 3), 1> around;
  draw(image, at_px, step, half + 1, around);
  Template out;
  for (Patch* patch : {&out.greys, &out.along_u, &out.along_v}) patch->resize(side * side);
  for (int v = 0, k = 0; v < side; ++v)
    for (int u = 0; u < side; ++u, ++k) {
      const float* at = &around[(v + 1) * wide + u + 1];
      out.greys[k] = *at;
      out.along_u[k] = 0.5F * (at[1] - at[-1]);
      out.along_v[k] = 0.5F * (at[wide] - at[-wide]);
    }
  out.greys -= out.greys.mean();
  out.squared = out.greys.square().sum();
  const auto pixels = static_cast<float>(side * side), contrast = static_cast<float>(config.least_contrast);
  if (out.squared < contrast * contrast * pixels) return std::nullopt;
  for (Patch* slope : {&out.along_u, &out.along_v}) {
    *slope -= slope->mean();
    *slope -= (*slope * out.greys).sum() / out.squared * out.greys;
  }
  Matrix2f H;
  H << out.along_u.square().sum(), (out.along_u * out.along_v).sum(), (out.along_u * out.along_v).sum(),
      out.along_v.square().sum();
  constexpr float kLeastRatio = 0.01F;  // of the smaller eigenvalue to the larger one: with less it is an edge
  if (!(H.determinant() > kLeastRatio * H.trace() * H.trace())) return std::nullopt;
  out.H_inverse = H.inverse();
  return out;
}

/// However well two patches agree, their greys are no better than that.
constexpr float kRounding2_grey2 = 1.0F;

/// One standard deviation of the shift along its worse direction.
float sigma_px(const Template& patch, float misfit2_grey2) {
  const Matrix2f& C = patch.H_inverse;
  const float middle = 0.5F * C.trace(), apart = std::sqrt(std::max(middle * middle - C.determinant(), 0.0F));
  return std::sqrt((middle + apart) * misfit2_grey2);
}

/// The surroundings of a keyframe's point of known depth, as they look from here.
std::optional<Template> template_of(const Keyframe& keyframe, std::size_t point, const Vector3d& ray_K,
                                    const SE3& T_C_K, const Camera& camera, const AlignConfig& config) {
  const FeatureDepth& depth = *keyframe.depths[point];
  const Vector3d p_K = depth.range_m * ray_K;
  const auto step = step_in_keyframe(p_K, depth.normal_C, T_C_K, camera, config.most_scale);
  const auto thought_px = camera.project(T_C_K.act(p_K));
  if (!step || !thought_px) return std::nullopt;
  auto patch = drawn_from(keyframe.image, keyframe.features.points_px[point], *step, config);
  if (patch) patch->thought_px = thought_px->cast<float>();
  return patch;
}

std::optional<Vector2f> laid_on(const cv::Mat& image, const Template& patch, const Vector2f& begin_px,
                                const AlignConfig& config) {
  const auto gate = static_cast<float>(config.gate_px), settled = static_cast<float>(config.settled_px);
  const Eigen::Index pixels = patch.greys.size();
  Patch greys(pixels);
  Vector2f at_px = begin_px;
  for (int i = 0; i < config.most_steps; ++i) {
    if (!holds(image, at_px, static_cast<float>(config.half_px + 1))) return std::nullopt;
    draw(image, at_px, Matrix2f::Identity(), config.half_px, greys);
    greys -= greys.mean();
    const float product = (greys * patch.greys).sum(), squared = greys.square().sum();
    if (!(product > 0.0F)) return std::nullopt;
    const float gain = product / patch.squared;
    const Vector2f slope_misfit((patch.along_u * greys).sum() / gain, (patch.along_v * greys).sum() / gain);
    const Vector2f step = patch.H_inverse * slope_misfit;
    at_px -= step;
    if (!((at_px - patch.thought_px).squaredNorm() <= gate * gate)) return std::nullopt;
    if (step.squaredNorm() > settled * settled) continue;
    const float correlation = product / std::sqrt(squared * patch.squared);
    const float misfit2 = (greys / gain - patch.greys).square().sum() / static_cast<float>(pixels) + kRounding2_grey2;
    if (correlation < static_cast<float>(config.least_correlation) ||
        sigma_px(patch, misfit2) > static_cast<float>(config.most_sigma_px))
      return std::nullopt;
    return at_px;
  }
  return std::nullopt;
}

}  // namespace

cv::Mat image_for_alignment(const cv::Mat& grey) {
  constexpr double kBlur_px = 0.8;
  cv::Mat smooth;
  cv::GaussianBlur(grey, smooth, {5, 5}, kBlur_px);
  return smooth;
}

std::optional<Vector2f> aligned(const cv::Mat& now, const Keyframe& keyframe, std::size_t point, const Vector3d& ray_K,
                                const Vector2f& at_px, const SE3& T_C_K, const Camera& camera,
                                const AlignConfig& config) {
  const auto patch = template_of(keyframe, point, ray_K, T_C_K, camera, config);
  return patch ? laid_on(now, *patch, at_px, config) : std::nullopt;
}

std::vector<PointTrack> tracked_points(const cv::Mat& now, const Features& features, const Keyframe& keyframe,
                                       std::span<const Vector3d> rays_K, std::span<const PointMatch> matches,
                                       const SE3& T_C_K, const Camera& camera, const AlignConfig& config) {
  std::vector<const PointMatch*> match_of(rays_K.size(), nullptr);
  for (const PointMatch& match : matches) match_of[static_cast<std::size_t>(match.reference)] = &match;
  const bool comparable = config.enabled && !now.empty() && !keyframe.image.empty();
  std::vector<PointTrack> tracked;
  for (std::size_t i = 0; i < rays_K.size(); ++i) {
    if (!keyframe.depths[i]) continue;
    const PointMatch* match = match_of[i];
    PointTrack track{.reference = static_cast<int>(i), .line_px = match != nullptr ? match->line_px : -1.0};
    if (match != nullptr) track.at_px = features.points_px[static_cast<std::size_t>(match->current)];
    std::optional<Vector2f> found;
    if (const auto patch = comparable ? template_of(keyframe, i, rays_K[i], T_C_K, camera, config) : std::nullopt) {
      if (match != nullptr) found = laid_on(now, *patch, track.at_px, config);
      if (!found) found = laid_on(now, *patch, patch->thought_px, config);
    }
    if (!found && match == nullptr) continue;
    track.aligned = found.has_value();
    if (found) track.at_px = *found;
    tracked.push_back(track);
  }
  return tracked;
}

}  // namespace pllit
