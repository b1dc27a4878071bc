#include "pllit/map/image_sampling.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

namespace pllit {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A point that falls into the image.
struct Projected {
  std::size_t index;
  Eigen::Vector2d pixel_px;
  float range_m;
  int cell;
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

/// The best value, by `better`, among the cells that reach within so many pixels of a cell's border: along rows, then
/// along columns.
template <class Better>
CellGrid spread(const CellGrid& grid, int radius_px, const Better& better) {
  const int reach = (radius_px + grid.cell_px - 1) / grid.cell_px;
  CellGrid along = grid, both = grid;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      for (int c = std::max(0, column - reach); c <= std::min(grid.columns - 1, column + reach); ++c) {
        float& best = along[row * grid.columns + column];
        best = better(best, grid[row * grid.columns + c]);
      }
  for (int row = 0; row < grid.rows; ++row)
    for (int r = std::max(0, row - reach); r <= std::min(grid.rows - 1, row + reach); ++r)
      for (int column = 0; column < grid.columns; ++column) {
        float& best = both[row * grid.columns + column];
        best = r == row ? better(best, along[row * grid.columns + column])
                        : better(best, along[r * grid.columns + column]);
      }
  return both;
}

std::vector<Projected> projected(const std::vector<Vector3f>& points_W, const SE3& T_W_C, const Camera& camera,
                                 const SamplingConfig& config, const CellGrid& grid) {
  const Matrix3d R_C_W = T_W_C.rotation().transpose();
  const Vector3d p_W_C = T_W_C.translation();
  const double border = config.border_px;
  std::vector<Projected> seen;
  for (std::size_t i = 0; i < points_W.size(); ++i) {
    const Vector3d p_C = R_C_W * (points_W[i].cast<double>() - p_W_C);
    const double range_m = p_C.norm();
    if (p_C.z() < 0.1 * range_m || range_m < config.min_range_m || range_m > config.max_range_m) continue;
    const auto pixel = camera.project(p_C);
    if (!pixel || pixel->x() < border || pixel->y() < border || pixel->x() > camera.width - 1.0 - border ||
        pixel->y() > camera.height - 1.0 - border)
      continue;
    seen.push_back({i, *pixel, static_cast<float>(range_m), grid.cell_at(*pixel)});
  }
  return seen;
}

/// Keeps what no nearer surface is close to, then what no farther one (of those in sight) is close to.
void keep_unobstructed(std::vector<Projected>& points, const CellGrid& empty, const SamplingConfig& config) {
  const auto nearer = [](float a, float b) { return std::min(a, b); };
  const auto farther = [](float a, float b) { return std::max(a, b); };
  const auto step_m = [&](const Projected& point) {
    return static_cast<float>(config.depth_step_m + config.depth_step_share * static_cast<double>(point.range_m));
  };
  CellGrid nearest = empty;
  for (const Projected& point : points) nearest[point.cell] = nearer(nearest[point.cell], point.range_m);
  CellGrid farthest = empty;
  std::ranges::fill(farthest.values, -kInfinity);
  for (const Projected& point : points)
    if (nearest[point.cell] >= point.range_m - step_m(point))
      farthest[point.cell] = farther(farthest[point.cell], point.range_m);
  nearest = spread(nearest, config.shadow_px, nearer);
  farthest = spread(farthest, config.edge_px, farther);
  std::erase_if(points, [&](const Projected& point) {
    return nearest[point.cell] < point.range_m - step_m(point) || farthest[point.cell] > point.range_m + step_m(point);
  });
}

float read_bilinear(const cv::Mat& image, const Eigen::Vector2d& pixel_px) {
  const int column = std::min(static_cast<int>(pixel_px.x()), image.cols - 2),
            row = std::min(static_cast<int>(pixel_px.y()), image.rows - 2);
  const auto x = static_cast<float>(pixel_px.x() - column), y = static_cast<float>(pixel_px.y() - row);
  const float* upper = image.ptr<float>(row) + column;
  const float* lower = image.ptr<float>(row + 1) + column;
  return (1.0F - y) * ((1.0F - x) * upper[0] + x * upper[1]) + y * ((1.0F - x) * lower[0] + x * lower[1]);
}

float read_raw(const cv::Mat& image, const Eigen::Vector2d& pixel_px) {
  const int column = static_cast<int>(pixel_px.x() + 0.5), row = static_cast<int>(pixel_px.y() + 0.5);
  return image.depth() == CV_8U ? static_cast<float>(image.at<std::uint8_t>(row, column))
                                : static_cast<float>(image.at<std::uint16_t>(row, column));
}

}  // namespace

std::vector<SurfaceObservation> sample_image(const SurfacePoints& points, const SE3& T_W_C, const Camera& camera,
                                             const ImagePair& images, const SamplingConfig& config) {
  assert(points.normals_W.empty() || points.normals_W.size() == points.points_W.size());
  assert(images.calibrated.type() == CV_32FC1 && images.calibrated.size() == images.raw.size());
  assert(images.raw.cols == camera.width && images.raw.rows == camera.height);
  assert(config.border_px >= 0);
  const CellGrid empty(camera, config.cell_px, kInfinity);
  std::vector<Projected> seen = projected(points.points_W, T_W_C, camera, config, empty);
  keep_unobstructed(seen, empty, config);

  const auto px_per_rad = static_cast<float>(0.5 * (camera.fx + camera.fy));
  std::vector<SurfaceObservation> observations;
  observations.reserve(seen.size());
  for (const Projected& point : seen) {
    SurfaceObservation observation{.p_W = points.points_W[point.index].cast<double>(),
                                   .pixel_px = point.pixel_px.cast<float>()};
    if (!points.normals_W.empty() && !points.normals_W[point.index].isZero()) {
      const Vector3d ray_W = (observation.p_W - T_W_C.translation()).normalized();
      observation.cos_incidence = static_cast<float>(std::abs(ray_W.dot(points.normals_W[point.index].cast<double>())));
      if (observation.cos_incidence < static_cast<float>(config.min_cos_incidence)) continue;
    }
    observation.intensity = read_bilinear(images.calibrated, point.pixel_px);
    observation.raw = read_raw(images.raw, point.pixel_px);
    observation.range_m = point.range_m;
    observation.footprint_m = point.range_m / px_per_rad;
    observations.push_back(observation);
  }
  return observations;
}

}  // namespace pllit
