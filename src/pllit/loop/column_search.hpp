// Where the upright things of one submap meet those of another: the first, coarse step of a registration.
#pragma once

#include <cmath>

#include "pllit/base/evenly.hpp"
#include "pllit/loop/submap.hpp"

namespace pllit {

/// A motion in the plane: p_a = Rz(yaw) p_b + t.
struct PlanePose {
  Eigen::Vector2d t_m = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
};

/// What a motion between level frames is in the plane.
inline PlanePose in_plane(const SE3& T_a_b) {
  const Matrix3d R = T_a_b.rotation();
  return {T_a_b.translation().head<2>(), std::atan2(R(1, 0), R(0, 0))};
}

struct SearchWindow {
  PlanePose centre;
  double reach_m = 5.0;     ///< to each side, along both axes
  double reach_rad = 0.15;  ///< to each side
};

struct ColumnMatch {
  PlanePose T_a_b;
  double score = 0.0;      ///< mean nearness of b's columns to a's: 1 where each has one in its place
  double runner_up = 0.0;  ///< the best score at least 3 m or 8 degrees away
};

/// Nearness to the columns of a submap, on a grid: 1 in their middle, falling like a Gaussian.
class ColumnField {
 public:
  explicit ColumnField(const std::vector<Column>& columns);
  float at(const Eigen::Vector2f& p) const {
    const Eigen::Vector2i cell = ((p.array() + reach_m) * (1.0F / cell_m)).floor().cast<int>();
    return (cell.array() < 0).any() || (cell.array() >= size).any() ? 0.0F : values_[index(cell)];
  }

 private:
  static constexpr float cell_m = 0.5F, reach_m = 60.0F;
  static constexpr int size = 240;
  static std::size_t index(const Eigen::Vector2i& cell) { return static_cast<std::size_t>(cell.y() * size + cell.x()); }
  std::vector<float> values_;
};

/// Tries all motions of the window (correlative scan matching, Olson, ICRA 2009), then refines the best. `b` is best
/// thinned to a few hundred columns.
ColumnMatch search(const ColumnField& a, const std::vector<Column>& b, const SearchWindow& window);

/// Share of b's columns within `radius_m` of its anchor that have one of a's within 0.7 m.
double overlap(const ColumnField& a, const std::vector<Column>& b, const PlanePose& T_a_b, double radius_m);

}  // namespace pllit
