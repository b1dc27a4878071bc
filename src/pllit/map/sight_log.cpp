#include "pllit/map/sight_log.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pllit {
namespace {

/// atan2 within 1e-5 rad, a thousandth of a cell, in a fraction of its time (Abramowitz and Stegun, 4.4.47).
inline float angle_of(float y, float x) {
  constexpr float kPi = std::numbers::pi_v<float>, kTiny = 1e-30F;
  const float across = std::abs(x), along = std::abs(y);
  const float t = std::min(across, along) / (std::max(across, along) + kTiny), s = t * t;
  float angle = t * (0.9998660F + s * (-0.3302995F + s * (0.1801410F + s * (-0.0851330F + s * 0.0208351F))));
  angle = along > across ? 0.5F * kPi - angle : angle;
  angle = x < 0.0F ? kPi - angle : angle;
  return std::copysign(angle, y);
}

/// Rows from straight down to straight up, columns once around.
struct Cells {
  int columns, rows;
  float per_rad;

  explicit Cells(const SightConfig& config)
      : columns(static_cast<int>(std::ceil(360.0 / config.cell_deg))),
        rows(static_cast<int>(std::ceil(180.0 / config.cell_deg))),
        per_rad(static_cast<float>(180.0 / std::numbers::pi / config.cell_deg)) {}

  std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row * columns + (column + columns) % columns);
  }
  int column_of(const Vector3f& ray) const {
    constexpr float kPi = std::numbers::pi_v<float>;
    return std::clamp(static_cast<int>((angle_of(ray.y(), ray.x()) + kPi) * per_rad), 0, columns - 1);
  }
  int row_of(const Vector3f& ray) const {
    constexpr float kQuarter = 0.5F * std::numbers::pi_v<float>;
    const float across = std::sqrt(ray.x() * ray.x() + ray.y() * ray.y());
    return std::clamp(static_cast<int>((angle_of(ray.z(), across) + kQuarter) * per_rad), 0, rows - 1);
  }
};

/// A point as a sight sees it: by the nearest surface in the cells around.
class Aim {
 public:
  Aim(const Sight& sight, const Vector3d& p_W, const SightConfig& config) : sight_(sight), cells_(config) {
    const Vector3f ray = (p_W - sight.p_W).cast<float>();
    column_ = cells_.column_of(ray);
    row_ = cells_.row_of(ray);
    const double range_m = static_cast<double>(ray.norm()), margin_m = config.margin_m + config.margin_share * range_m;
    near_mm_ = 1000.0 * (range_m - margin_m);
    far_mm_ = 1000.0 * (range_m + margin_m);
  }

  PointSight own() const {
    const int range_mm = sight_.range_mm[cells_.at(column_, row_)];
    return range_mm == 0 ? PointSight::unknown : seen(range_mm);
  }
  /// By the cells around too, of which a third must have been measured.
  PointSight around() const {
    constexpr int kReach = 1;
    int measured = 0, nearest_mm = 65535;
    for (int r = std::max(0, row_ - kReach); r <= std::min(cells_.rows - 1, row_ + kReach); ++r)
      for (int c = column_ - kReach; c <= column_ + kReach; ++c) {
        const int range_mm = sight_.range_mm[cells_.at(c, r)];
        if (range_mm == 0) continue;
        ++measured;
        nearest_mm = std::min(nearest_mm, range_mm);
      }
    return 3 * measured < (2 * kReach + 1) * (2 * kReach + 1) ? PointSight::unknown : seen(nearest_mm);
  }

  /// Whether around() says free. What is nearer in the own cell mostly says no already.
  bool is_free() const {
    const PointSight seen_there = own();
    return seen_there != PointSight::surface && seen_there != PointSight::hidden && around() == PointSight::free;
  }

  /// Whether the cells around that were measured lie on all sides: rays that pass a point on one side only may have
  /// missed what is there.
  bool is_surrounded() const {
    bool below = false, above = false, left = false, right = false;
    for (int i = -1; i <= 1; ++i) {
      below |= measured(row_ - 1, column_ + i);
      above |= measured(row_ + 1, column_ + i);
      left |= measured(row_ + i, column_ - 1);
      right |= measured(row_ + i, column_ + 1);
    }
    return below && above && left && right;
  }

 private:
  bool measured(int row, int column) const {
    return row >= 0 && row < cells_.rows && sight_.range_mm[cells_.at(column, row)] != 0;
  }
  PointSight seen(int range_mm) const {
    return range_mm > far_mm_ ? PointSight::free : range_mm < near_mm_ ? PointSight::hidden : PointSight::surface;
  }

  const Sight& sight_;
  Cells cells_;
  int column_, row_;
  double near_mm_, far_mm_;
};

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
  const auto max_range_m = static_cast<float>(std::min(config.max_range_m, 65.0));
  const Vector3f from_W = p_W.cast<float>();
  for (const Vector3f& point_W : points_W) {
    const Vector3f ray = point_W - from_W;
    const float range_m = ray.norm();
    if (range_m > max_range_m || range_m < 0.01F) continue;
    std::uint16_t& nearest_mm = sight.range_mm[cells.at(cells.column_of(ray), cells.row_of(ray))];
    const auto range_mm = static_cast<std::uint16_t>(range_m * 1000.0F);
    if (nearest_mm == 0 || range_mm < nearest_mm) nearest_mm = range_mm;
  }
  return sight;
}

PointSight look_at(const Sight& sight, const Vector3d& p_W, const SightConfig& config) {
  return Aim(sight, p_W, config).own();
}

PointSight look_around(const Sight& sight, const Vector3d& p_W, const SightConfig& config) {
  return Aim(sight, p_W, config).around();
}

bool is_seen_through(const Sight& sight, const Vector3d& p_W, const SightConfig& config) {
  return Aim(sight, p_W, config).is_free();
}

bool SightLog::is_due(Time time, const Vector3d& p_W) const {
  return sights_.empty() || (p_W - sights_.back().p_W).norm() >= config_.spacing_m ||
         to_seconds(time - sights_.back().time) >= config_.spacing_s;
}

void SightLog::add(Sight sight) {
  if (!is_due(sight.time, sight.p_W)) return;
  sights_.push_back(std::move(sight));
  if (static_cast<int>(sights_.size()) > config_.most) sights_.pop_front();
}

SightEvidence SightLog::evidence(const Vector3d& p_W, Time before) const {
  SightEvidence evidence;
  std::vector<Look> looks;
  for (const Sight& sight : sights_) {
    if (sight.time >= before) break;
    const Aim aim(sight, p_W, config_);
    const bool surface = aim.own() == PointSight::surface;
    // A sight's rays come from where the rig was during a few scans: what they pass at a rim is more than a cell.
    if (!surface && !(aim.is_free() && aim.is_surrounded())) continue;
    looks.push_back({surface, (p_W - sight.p_W).norm()});
    ++(surface ? evidence.surface : evidence.free);
  }
  evidence.came = tell_of_a_coming(looks);
  return evidence;
}

}  // namespace pllit
