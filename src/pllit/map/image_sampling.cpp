#include "pllit/map/image_sampling.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "pllit/map/obstruction.hpp"

namespace pllit {
namespace {

std::vector<Projected> projected(const SurfacePoints& points, const SE3& T_W_C, const Camera& camera,
                                 const SamplingConfig& config, const CellGrid& grid) {
  const Matrix3d R_C_W = T_W_C.rotation().transpose();
  const Vector3d p_W_C = T_W_C.translation();
  const double border = config.border_px;
  std::vector<Projected> seen;
  for (std::size_t i = 0; i < points.points_W.size(); ++i) {
    const Vector3d ray_W = points.points_W[i].cast<double>() - p_W_C, p_C = R_C_W * ray_W;
    const double range_m = p_C.norm();
    if (p_C.z() < 0.1 * range_m || range_m < config.min_range_m || range_m > config.max_range_m) continue;
    const auto pixel = camera.project(p_C);
    if (!pixel || pixel->x() < border || pixel->y() < border || pixel->x() > camera.width - 1.0 - border ||
        pixel->y() > camera.height - 1.0 - border)
      continue;
    const Vector3f from_camera_W = ray_W.cast<float>();
    const Vector3f normal_W = points.normals_W.empty() ? Vector3f(Vector3f::Zero()) : points.normals_W[i];
    const float towards = normal_W.dot(from_camera_W) > 0.0F ? -1.0F : 1.0F;
    seen.push_back({.index = i,
                    .pixel_px = *pixel,
                    .range_m = static_cast<float>(range_m),
                    .cell = grid.cell_at(*pixel),
                    .p_W = from_camera_W,
                    .normal_W = towards * normal_W,
                    .fresh = !points.fresh.empty() && points.fresh[i] != 0});
  }
  return seen;
}

/// Keeps what no nearer surface is close to, nor a farther one (of those in sight).
std::vector<Projected> unobstructed(const std::vector<Projected>& points, const CellGrid& empty, const Camera& camera,
                                    const SamplingConfig& config) {
  const Obstruction obstruction(points, empty, camera, config);
  std::vector<Projected> kept;
  std::ranges::copy_if(points, std::back_inserter(kept),
                       [&](const Projected& point) { return !obstruction.is_obstructed(point); });
  return kept;
}

float read_bilinear(const cv::Mat& image, const Eigen::Vector2d& pixel_px) {
  const int column = std::min(static_cast<int>(pixel_px.x()), image.cols - 2),
            row = std::min(static_cast<int>(pixel_px.y()), image.rows - 2);
  const auto x = static_cast<float>(pixel_px.x() - column), y = static_cast<float>(pixel_px.y() - row);
  const float* upper = image.ptr<float>(row) + column;
  const float* lower = image.ptr<float>(row + 1) + column;
  return (1.0F - y) * ((1.0F - x) * upper[0] + x * upper[1]) + y * ((1.0F - x) * lower[0] + x * lower[1]);
}

/// What an image shows around its pixels, dips and rises alike smoothed over 3 x 3 pixels, for noise is neither.
struct Around {
  cv::Mat smooth, least, most;  ///< the latter two within a square of so many pixels to all sides

  Around(const cv::Mat& image, int radius_px) {
    cv::blur(image, smooth, {3, 3});
    const cv::Mat square = cv::Mat::ones(2 * radius_px + 1, 2 * radius_px + 1, CV_8U);
    cv::erode(smooth, least, square);
    cv::dilate(smooth, most, square);
  }
};

template <class Pixel>
Pixel read_nearest(const cv::Mat& image, const Eigen::Vector2d& pixel_px) {
  return image.ptr<Pixel>(static_cast<int>(pixel_px.y() + 0.5))[static_cast<int>(pixel_px.x() + 0.5)];
}

/// How much an image shows of what was at a point's pixel before: a pixel follows the scene at the rate of their
/// difference over the time constant, and the scene passes it along the point's way, so that the difference is the
/// image's slope along what of that way a time constant takes.
float smeared(const cv::Mat& smooth, const Vector3f& p_W, const Eigen::Vector2d& pixel_px, const Camera& camera,
              const SE3& T_W_C_before) {
  constexpr double kStep_px = 2.0, kStill_px = 0.5;
  const Vector3d p_C = T_W_C_before.inverse().act(p_W.cast<double>());
  const auto before_px = p_C.z() > 0.0 ? camera.project(p_C) : std::nullopt;
  if (!before_px) return 0.0F;
  const Eigen::Vector2d way_px = pixel_px - *before_px;
  const double length_px = way_px.norm();
  if (length_px < kStill_px) return 0.0F;
  const Eigen::Vector2d step_px = kStep_px / length_px * way_px;
  const auto read = [&](const Eigen::Vector2d& at_px) {
    return read_bilinear(smooth, at_px.cwiseMax(0.0).cwiseMin(Eigen::Vector2d(smooth.cols - 1, smooth.rows - 1)));
  };
  const float rise = read(pixel_px + step_px) - read(pixel_px - step_px);
  return std::abs(rise) * static_cast<float>(0.5 * length_px / kStep_px);
}

float read_raw(const cv::Mat& image, const Eigen::Vector2d& pixel_px) {
  return image.depth() == CV_8U ? static_cast<float>(read_nearest<std::uint8_t>(image, pixel_px))
                                : static_cast<float>(read_nearest<std::uint16_t>(image, pixel_px));
}

}  // namespace

std::vector<SurfaceObservation> sample_image(const SurfacePoints& points, const SE3& T_W_C, const Camera& camera,
                                             const ImagePair& images, const SamplingConfig& config,
                                             const std::optional<Smear>& smear) {
  assert(points.normals_W.empty() || points.normals_W.size() == points.points_W.size());
  assert(points.fresh.empty() || points.fresh.size() == points.points_W.size());
  assert(images.calibrated.type() == CV_32FC1 && images.calibrated.size() == images.raw.size());
  assert(images.raw.cols == camera.width && images.raw.rows == camera.height);
  assert(config.border_px >= 0);
  const CellGrid empty(camera, config.cell_px);
  const std::vector<Projected> seen =
      unobstructed(projected(points, T_W_C, camera, config, empty), empty, camera, config);

  const Around around(images.calibrated, config.aim_px);
  const auto per_rad = static_cast<float>(px_per_rad(camera));
  std::vector<SurfaceObservation> observations;
  observations.reserve(seen.size());
  for (const Projected& point : seen) {
    SurfaceObservation observation{.p_W = points.points_W[point.index].cast<double>(),
                                   .pixel_px = point.pixel_px.cast<float>()};
    if (!point.normal_W.isZero()) observation.cos_incidence = point.cos_incidence();
    if (observation.cos_incidence < static_cast<float>(config.min_cos_incidence)) continue;
    if (smear &&
        smeared(around.smooth, points.points_W[point.index], point.pixel_px, camera, smear->T_W_C_before) > smear->most)
      continue;
    observation.intensity = read_bilinear(images.calibrated, point.pixel_px);
    observation.dip = std::max(0.0F, observation.intensity - read_nearest<float>(around.least, point.pixel_px));
    observation.rise = std::max(0.0F, read_nearest<float>(around.most, point.pixel_px) - observation.intensity);
    observation.raw = read_raw(images.raw, point.pixel_px);
    observation.range_m = point.range_m;
    observation.footprint_m = point.range_m / per_rad;
    observations.push_back(observation);
  }
  return observations;
}

}  // namespace pllit
