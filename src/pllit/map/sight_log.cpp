#include "pllit/map/sight_log.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>

namespace pllit {
namespace {

/// Rows from straight down to straight up, columns once around.
struct Cells {
  int columns, rows;
  double per_rad;

  explicit Cells(const SightConfig& config)
      : columns(static_cast<int>(std::ceil(360.0 / config.cell_deg))),
        rows(static_cast<int>(std::ceil(180.0 / config.cell_deg))),
        per_rad(180.0 / std::numbers::pi / config.cell_deg) {}

  std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row * columns + (column + columns) % columns);
  }
  int column_of(const Vector3d& ray) const {
    return std::min(columns - 1, static_cast<int>((std::atan2(ray.y(), ray.x()) + std::numbers::pi) * per_rad));
  }
  int row_of(const Vector3d& ray) const {
    const double elevation = std::atan2(ray.z(), ray.head<2>().norm());
    return std::clamp(static_cast<int>((elevation + 0.5 * std::numbers::pi) * per_rad), 0, rows - 1);
  }
};

/// By the nearest surface within `reach` cells, of which a third must have been measured.
PointSight look(const Sight& sight, const Vector3d& p_W, int reach, const SightConfig& config) {
  const Cells cells(config);
  const Vector3d ray = p_W - sight.p_W;
  const double range_m = ray.norm();
  const int column = cells.column_of(ray), row = cells.row_of(ray);
  int measured = 0, nearest_mm = 65535;
  for (int r = std::max(0, row - reach); r <= std::min(cells.rows - 1, row + reach); ++r)
    for (int c = column - reach; c <= column + reach; ++c) {
      const int range_mm = sight.range_mm[cells.at(c, r)];
      if (range_mm == 0) continue;
      ++measured;
      nearest_mm = std::min(nearest_mm, range_mm);
    }
  if (3 * measured < (2 * reach + 1) * (2 * reach + 1)) return PointSight::unknown;
  const double margin_m = config.margin_m + config.margin_share * range_m, nearest_m = 1e-3 * nearest_mm;
  return nearest_m > range_m + margin_m   ? PointSight::free
         : nearest_m < range_m - margin_m ? PointSight::hidden
                                          : PointSight::surface;
}

/// What a sight says about a point, surface or free, and from how far away.
struct Look {
  bool surface;
  double range_m;
};

/// Whether looks tell of something that came: split in time where they contradict that least, the point was free
/// before and a surface after. What is thin is seen through from afar although it was always there: only what looked
/// from no farther than where the surface was seen from speaks of that.
bool tell_of_a_coming(const std::vector<Look>& looks) {
  constexpr int kFewest = 6, kMajority = 4;
  int contradicting = 0;  // surfaces before the split and free looks after it
  for (const Look& look : looks) contradicting += look.surface ? 0 : 1;
  int fewest = contradicting;
  std::size_t split = 0;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    contradicting += looks[i].surface ? 1 : -1;
    if (contradicting >= fewest) continue;
    fewest = contradicting;
    split = i + 1;
  }
  double farthest_m = 0.0;
  int free_before = 0, surface_before = 0, free_after = 0, surface_after = 0;
  for (std::size_t i = split; i < looks.size(); ++i) {
    ++(looks[i].surface ? surface_after : free_after);
    if (looks[i].surface) farthest_m = std::max(farthest_m, looks[i].range_m);
  }
  for (std::size_t i = 0; i < split; ++i)
    if (looks[i].surface || looks[i].range_m <= farthest_m) ++(looks[i].surface ? surface_before : free_before);
  return free_before >= kFewest && free_before >= kMajority * surface_before && surface_after >= kMajority * free_after;
}

}  // namespace

Sight sight_of(Time time, const Vector3d& p_W, std::span<const Vector3f> points_W, const SightConfig& config) {
  const Cells cells(config);
  Sight sight{.time = time, .p_W = p_W, .range_mm = std::vector<std::uint16_t>(cells.count(), 0)};
  const double max_range_m = std::min(config.max_range_m, 65.0);
  for (const Vector3f& point_W : points_W) {
    const Vector3d ray = point_W.cast<double>() - p_W;
    const double range_m = ray.norm();
    if (range_m > max_range_m || range_m < 0.01) continue;
    std::uint16_t& nearest_mm = sight.range_mm[cells.at(cells.column_of(ray), cells.row_of(ray))];
    const auto range_mm = static_cast<std::uint16_t>(range_m * 1000.0);
    if (nearest_mm == 0 || range_mm < nearest_mm) nearest_mm = range_mm;
  }
  return sight;
}

PointSight look_at(const Sight& sight, const Vector3d& p_W, const SightConfig& config) {
  return look(sight, p_W, 0, config);
}

PointSight look_around(const Sight& sight, const Vector3d& p_W, const SightConfig& config) {
  return look(sight, p_W, 1, config);
}

void SightLog::add(Sight sight) {
  if (!sights_.empty() && (sight.p_W - sights_.back().p_W).norm() < config_.spacing_m &&
      to_seconds(sight.time - sights_.back().time) < config_.spacing_s)
    return;
  sights_.push_back(std::move(sight));
  if (static_cast<int>(sights_.size()) > config_.most) sights_.pop_front();
}

SightEvidence SightLog::evidence(const Vector3d& p_W, Time before) const {
  SightEvidence evidence;
  std::vector<Look> looks;
  for (const Sight& sight : sights_) {
    if (sight.time >= before) break;
    const bool surface = look_at(sight, p_W, config_) == PointSight::surface;
    // A sight's rays come from where the rig was during a few scans: what they pass at a rim is more than a cell.
    if (!surface && look_around(sight, p_W, config_) != PointSight::free) continue;
    looks.push_back({surface, (p_W - sight.p_W).norm()});
    ++(surface ? evidence.surface : evidence.free);
  }
  evidence.came = tell_of_a_coming(looks);
  return evidence;
}

}  // namespace pllit
