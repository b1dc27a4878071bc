#include "pllit/map/image_sampling.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace pllit {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

double px_per_rad(const Camera& camera) { return 0.5 * (camera.fx + camera.fy); }

/// A point that falls into the image.
struct Projected {
  std::size_t index;
  Eigen::Vector2d pixel_px;
  float range_m;
  int cell;
  Vector3f p_W;       ///< from the camera
  Vector3f normal_W;  ///< towards the camera; zero where it is not known
  bool fresh;         ///< measured by the last scans, so that nothing hides it

  float cos_incidence() const { return -p_W.dot(normal_W) / range_m; }
};

/// A number for each cell of an image.
struct CellGrid {
  int columns, rows, cell_px;
  std::vector<float> values;

  CellGrid(const Camera& camera, int cell, float value)
      : columns((camera.width + cell - 1) / cell),
        rows((camera.height + cell - 1) / cell),
        cell_px(cell),
        values(static_cast<std::size_t>(columns * rows), value) {}

  int cell_at(const Eigen::Vector2d& pixel_px) const {
    return static_cast<int>(pixel_px.y() + 0.5) / cell_px * columns + static_cast<int>(pixel_px.x() + 0.5) / cell_px;
  }
  float& operator[](int cell) { return values[static_cast<std::size_t>(cell)]; }
  float operator[](int cell) const { return values[static_cast<std::size_t>(cell)]; }
};

/// The best value, by `better`, of those that reach a cell: each reaches `reach(value)` cells to all sides, a better
/// one no less far, so that rows and then columns find the same.
template <class Better, class Reach>
CellGrid spread(const CellGrid& grid, const Better& better, const Reach& reach) {
  CellGrid along = grid, both = grid;
  const auto scatter = [&](const CellGrid& from, CellGrid& to, int i, int place, int places, int stride) {
    const float value = from[i];
    if (std::isinf(value)) return;
    const int far = reach(value);
    for (int k = std::max(0, place - far); k <= std::min(places - 1, place + far); ++k) {
      float& best = to[i + (k - place) * stride];
      best = better(best, value);
    }
  };
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      scatter(grid, along, row * grid.columns + column, column, grid.columns, 1);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      scatter(along, both, row * grid.columns + column, row, grid.rows, grid.columns);
  return both;
}

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

/// Which points lie too near in the image to surfaces nearer or farther than their own.
class Obstruction {
 public:
  Obstruction(const std::vector<Projected>& points, const CellGrid& empty, const Camera& camera,
              const SamplingConfig& config)
      : points_(points),
        config_(config),
        shadow_px_m_(config.shadow_m * px_per_rad(camera)),
        edge_rad_((config.edge_px + empty.cell_px) / px_per_rad(camera)),
        first_(empty.values.size(), kNone),
        nearest_(empty),
        farthest_(empty) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::size_t& first = first_[static_cast<std::size_t>(points[i].cell)];
      if (first == kNone || points[i].range_m < points[first].range_m) first = i;
    }
    for (const std::size_t i : first_)
      if (i != kNone) nearest_[points[i].cell] = points[i].range_m;
    const auto nearer = [](float a, float b) { return std::min(a, b); };
    covering_ = spread(nearest_, nearer, [&](float range_m) { return spacing(range_m); });
    reaching_ = spread(nearest_, nearer, [&](float range_m) { return shadow(range_m); });
    std::ranges::fill(farthest_.values, -kInfinity);
    for (const Projected& point : points)
      if (!is_covered(point)) farthest_[point.cell] = std::max(farthest_[point.cell], point.range_m);
    farthest_ = spread(
        farthest_, [](float a, float b) { return std::max(a, b); }, [&](float) { return cells(config.edge_px); });
  }

  bool is_obstructed(const Projected& point) const {
    if (farthest_[point.cell] > point.range_m + edge_step_m(point)) return true;
    const float nearest_m = reaching_[point.cell];
    if (point.normal_W.isZero()) return nearest_m < point.range_m - step_m(point);
    return nearest_m < point.range_m && stands_before(point, shadow(nearest_m));
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  int cells(double px) const { return static_cast<int>(std::ceil(px / nearest_.cell_px)); }
  /// Cells that lie between the points of a surface.
  int spacing(float range_m) const { return cells(shadow_px_m_ / static_cast<double>(range_m)); }
  /// Cells around a point of a surface that it may hide.
  int shadow(float range_m) const { return cells(config_.shadow_px + shadow_px_m_ / static_cast<double>(range_m)); }
  /// What makes one surface nearer than another where its slope is not known.
  float step_m(const Projected& point) const {
    return static_cast<float>(config_.depth_step_m + config_.depth_step_share * static_cast<double>(point.range_m));
  }
  float edge_step_m(const Projected& point) const {
    if (point.normal_W.isZero()) return step_m(point);
    const auto cos = static_cast<double>(std::max(0.05F, point.cos_incidence()));
    const double slope = std::sqrt(std::max(0.0, 1.0 - cos * cos)) / cos;  // of range over way across
    return static_cast<float>(config_.depth_step_m + slope * static_cast<double>(point.range_m) * edge_rad_);
  }

  /// Whether a nearer surface hides a point: one that lies in its cell, or on all sides of what was measured before.
  bool is_covered(const Projected& point) const {
    const float before_m = point.range_m - step_m(point), covering_m = covering_[point.cell];
    if (nearest_[point.cell] < before_m) return true;
    if (point.fresh || covering_m >= before_m) return false;
    const int column = point.cell % nearest_.columns, row = point.cell / nearest_.columns, reach = spacing(covering_m);
    for (int r = std::max(0, row - reach); r <= std::min(nearest_.rows - 1, row + reach); ++r)
      for (int c = std::max(0, column - reach); c <= std::min(nearest_.columns - 1, column + reach); ++c)
        if (covering_[r * nearest_.columns + c] >= before_m) return false;
    return true;
  }

  /// Whether, among the cells around, the first surface of any reaches the point and stands out of its plane.
  bool stands_before(const Projected& point, int reach) const {
    const int column = point.cell % nearest_.columns, row = point.cell / nearest_.columns;
    for (int r = std::max(0, row - reach); r <= std::min(nearest_.rows - 1, row + reach); ++r)
      for (int c = std::max(0, column - reach); c <= std::min(nearest_.columns - 1, column + reach); ++c) {
        const float range_m = nearest_[r * nearest_.columns + c];
        if (!(range_m < point.range_m) || std::max(std::abs(r - row), std::abs(c - column)) > shadow(range_m)) continue;
        const Projected& other = points_[first_[static_cast<std::size_t>(r * nearest_.columns + c)]];
        if (point.normal_W.dot(other.p_W - point.p_W) > static_cast<float>(config_.depth_step_m)) return true;
      }
    return false;
  }

  const std::vector<Projected>& points_;
  const SamplingConfig& config_;
  double shadow_px_m_, edge_rad_;
  std::vector<std::size_t> first_;  ///< nearest point of each cell
  CellGrid nearest_;                ///< its range
  CellGrid covering_ = nearest_;    ///< the least range of the surfaces between whose points a cell may lie
  CellGrid reaching_ = nearest_;    ///< the least range of those whose shadows reach a cell
  CellGrid farthest_;               ///< the greatest of those in sight next to a cell
};

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

/// The least and the most of an image within so many pixels of one: every other pixel, which a smoothed image allows.
std::pair<float, float> range_around(const cv::Mat& smooth, const Eigen::Vector2d& pixel_px, int radius_px) {
  const int column = static_cast<int>(pixel_px.x() + 0.5), row = static_cast<int>(pixel_px.y() + 0.5);
  float least = smooth.at<float>(row, column), most = least;
  for (int r = std::max(0, row - radius_px); r <= std::min(smooth.rows - 1, row + radius_px); r += 2)
    for (int c = std::max(0, column - radius_px); c <= std::min(smooth.cols - 1, column + radius_px); c += 2) {
      const float value = smooth.ptr<float>(r)[c];
      least = std::min(least, value);
      most = std::max(most, value);
    }
  return {least, most};
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
  const int column = static_cast<int>(pixel_px.x() + 0.5), row = static_cast<int>(pixel_px.y() + 0.5);
  return image.depth() == CV_8U ? static_cast<float>(image.at<std::uint8_t>(row, column))
                                : static_cast<float>(image.at<std::uint16_t>(row, column));
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
  const CellGrid empty(camera, config.cell_px, kInfinity);
  const std::vector<Projected> seen =
      unobstructed(projected(points, T_W_C, camera, config, empty), empty, camera, config);

  cv::Mat smooth;
  cv::blur(images.calibrated, smooth, {3, 3});
  const auto per_rad = static_cast<float>(px_per_rad(camera));
  std::vector<SurfaceObservation> observations;
  observations.reserve(seen.size());
  for (const Projected& point : seen) {
    SurfaceObservation observation{.p_W = points.points_W[point.index].cast<double>(),
                                   .pixel_px = point.pixel_px.cast<float>()};
    if (!point.normal_W.isZero()) observation.cos_incidence = point.cos_incidence();
    if (observation.cos_incidence < static_cast<float>(config.min_cos_incidence)) continue;
    if (smear &&
        smeared(smooth, points.points_W[point.index], point.pixel_px, camera, smear->T_W_C_before) > smear->most)
      continue;
    observation.intensity = read_bilinear(images.calibrated, point.pixel_px);
    const auto [least, most] = range_around(smooth, point.pixel_px, config.aim_px);
    observation.dip = std::max(0.0F, observation.intensity - least);
    observation.rise = std::max(0.0F, most - observation.intensity);
    observation.raw = read_raw(images.raw, point.pixel_px);
    observation.range_m = point.range_m;
    observation.footprint_m = point.range_m / per_rad;
    observations.push_back(observation);
  }
  return observations;
}

}  // namespace pllit
