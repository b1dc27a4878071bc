#include "pllit/map/obstruction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pllit {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

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

}  // namespace

Obstruction::Obstruction(const std::vector<Projected>& points, const CellGrid& empty, const Camera& camera,
                         const SamplingConfig& config)
    : config_(config),
      shadow_px_m_(static_cast<float>(config.shadow_m * px_per_rad(camera))),
      edge_rad_((config.edge_px + empty.cell_px) / px_per_rad(camera)),
      nearest_(empty),
      farthest_(empty),
      shadow_(empty.values.size()) {
  nearest_W_.fill(std::vector<float>(empty.values.size()));
  for (const Projected& point : points) {
    float& nearest_m = nearest_[point.cell];
    if (point.range_m >= nearest_m) continue;
    nearest_m = point.range_m;
    for (int i = 0; i < 3; ++i) nearest_W_[i][static_cast<std::size_t>(point.cell)] = point.p_W[i];
  }
  for (std::size_t i = 0; i < shadow_.size(); ++i)
    if (!std::isinf(nearest_.values[i])) shadow_[i] = shadow(nearest_.values[i]);
  const auto nearer = [](float a, float b) { return std::min(a, b); };
  covering_ = spread(nearest_, nearer, [&](float range_m) { return spacing(range_m); });
  reaching_ = spread(nearest_, nearer, [&](float range_m) { return shadow(range_m); });
  std::ranges::fill(farthest_.values, -kInfinity);
  for (const Projected& point : points)
    if (!is_covered(point)) farthest_[point.cell] = std::max(farthest_[point.cell], point.range_m);
  farthest_ = spread(
      farthest_, [](float a, float b) { return std::max(a, b); },
      [&](float) { return cells(static_cast<float>(config.edge_px)); });
}

bool Obstruction::is_obstructed(const Projected& point) const {
  if (farthest_[point.cell] > point.range_m + edge_step_m(point)) return true;
  const float nearest_m = reaching_[point.cell];
  if (point.normal_W.isZero()) return nearest_m < point.range_m - step_m(point);
  return nearest_m < point.range_m && stands_before(point, shadow(nearest_m));
}

bool Obstruction::is_covered(const Projected& point) const {
  const float before_m = point.range_m - step_m(point), covering_m = covering_[point.cell];
  if (nearest_[point.cell] < before_m) return true;
  if (point.fresh || covering_m >= before_m) return false;
  const int column = point.cell % nearest_.columns, row = point.cell / nearest_.columns, reach = spacing(covering_m);
  for (int r = std::max(0, row - reach); r <= std::min(nearest_.rows - 1, row + reach); ++r)
    for (int c = std::max(0, column - reach); c <= std::min(nearest_.columns - 1, column + reach); ++c)
      if (covering_[r * nearest_.columns + c] >= before_m) return false;
  return true;
}

bool Obstruction::stands_before(const Projected& point, int reach) const {
  const int column = point.cell % nearest_.columns, row = point.cell / nearest_.columns;
  const int first = std::max(0, column - reach), last = std::min(nearest_.columns - 1, column + reach);
  const Vector3f n = point.normal_W;
  const float before_m = point.range_m, out_m = n.dot(point.p_W) + static_cast<float>(config_.depth_step_m);
  for (int r = std::max(0, row - reach); r <= std::min(nearest_.rows - 1, row + reach); ++r) {
    const auto start = static_cast<std::size_t>(r * nearest_.columns);
    const float *range_m = &nearest_.values[start], *x = &nearest_W_[0][start], *y = &nearest_W_[1][start],
                *z = &nearest_W_[2][start];
    const int *shadow = &shadow_[start], rows_away = std::abs(r - row);
    int any = 0;
    for (int c = first; c <= last; ++c) {
      const float along_m = n.x() * x[c] + n.y() * y[c] + n.z() * z[c];
      const int away = std::max(rows_away, std::abs(c - column));
      any |= (range_m[c] < before_m ? 1 : 0) & (away <= shadow[c] ? 1 : 0) & (along_m > out_m ? 1 : 0);
    }
    if (any != 0) return true;
  }
  return false;
}

}  // namespace pllit
