// What lies too near in an image to surfaces nearer or farther than its own for the image to be read there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "pllit/map/image_sampling.hpp"

namespace pllit {

inline double px_per_rad(const Camera& camera) { return 0.5 * (camera.fx + camera.fy); }

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

/// A number for each cell of an image, at first an infinite one.
struct CellGrid {
  int columns, rows, cell_px;
  std::vector<float> values;

  CellGrid(const Camera& camera, int cell)
      : columns((camera.width + cell - 1) / cell),
        rows((camera.height + cell - 1) / cell),
        cell_px(cell),
        values(static_cast<std::size_t>(columns * rows), std::numeric_limits<float>::infinity()) {}

  int cell_at(const Eigen::Vector2d& pixel_px) const {
    return static_cast<int>(pixel_px.y() + 0.5) / cell_px * columns + static_cast<int>(pixel_px.x() + 0.5) / cell_px;
  }
  float& operator[](int cell) { return values[static_cast<std::size_t>(cell)]; }
  float operator[](int cell) const { return values[static_cast<std::size_t>(cell)]; }
};

class Obstruction {
 public:
  /// By all points that fall into an image, in the cells of an empty grid; the configuration is to outlive it.
  Obstruction(const std::vector<Projected>& points, const CellGrid& empty, const Camera& camera,
              const SamplingConfig& config);

  /// Whether one of the points lies too near to a nearer or a farther surface.
  bool is_obstructed(const Projected& point) const;

 private:
  int cells(float px) const { return static_cast<int>(std::ceil(px / static_cast<float>(nearest_.cell_px))); }
  /// Cells that lie between the points of a surface.
  int spacing(float range_m) const { return cells(shadow_px_m_ / range_m); }
  /// Cells around a point of a surface that it may hide.
  int shadow(float range_m) const { return cells(static_cast<float>(config_.shadow_px) + shadow_px_m_ / range_m); }
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
  bool is_covered(const Projected& point) const;
  /// Whether, among the cells around, the first surface of any reaches the point and stands out of its plane. Row by
  /// row without a branch, for the compiler to take several cells at a time.
  bool stands_before(const Projected& point, int reach) const;

  const SamplingConfig& config_;
  float shadow_px_m_;
  double edge_rad_;
  CellGrid nearest_;                             ///< the range of a cell's first surface
  CellGrid covering_ = nearest_;                 ///< the least of the surfaces between whose points a cell may lie
  CellGrid reaching_ = nearest_;                 ///< the least of those whose shadows reach a cell
  CellGrid farthest_;                            ///< the greatest of those in sight next to a cell
  std::array<std::vector<float>, 3> nearest_W_;  ///< x, y, z of a cell's first point, from the camera
  std::vector<int> shadow_;                      ///< how many cells around its own that one may hide
};

}  // namespace pllit
