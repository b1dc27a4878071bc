// What was seen from where: coarse range images of the past all around the rig, which tell whether a surface is new.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/geometry/lie.hpp"

namespace pllit {

struct SightConfig {
  double cell_deg = 1.0;  ///< of azimuth and elevation
  double max_range_m = 40.0;
  double margin_m = 0.06, margin_share = 0.015;  ///< in depth, what is one surface; the share is of the range
  double spacing_m = 0.25;                       ///< a sight is kept where the rig has moved so far ...
  double spacing_s = 1.0;                        ///< ... or stood for so long
  int most = 300;                                ///< sights kept; then the oldest goes
};

/// The nearest surface in each direction from a place, by azimuth and elevation in W.
struct Sight {
  Time time{};
  Vector3d p_W = Vector3d::Zero();
  std::vector<std::uint16_t> range_mm{};  ///< zero where no point fell
};

/// What a sight says about a point.
enum class PointSight {
  unknown,  ///< no surface was measured in that direction
  hidden,   ///< something stood before it
  surface,  ///< there was a surface
  free      ///< a surface behind it was seen through where it is
};

/// Points as seen from p_W.
Sight sight_of(Time time, const Vector3d& p_W, std::span<const Vector3f> points_W, const SightConfig& config);
/// By the direction's own cell: what a sight knows of a point.
PointSight look_at(const Sight& sight, const Vector3d& p_W, const SightConfig& config);
/// By the cells around it too: free only where nothing near the direction is nearer. At edges one cell alone says too
/// much.
PointSight look_around(const Sight& sight, const Vector3d& p_W, const SightConfig& config);
/// Whether look_around says free, in less time.
bool is_seen_through(const Sight& sight, const Vector3d& p_W, const SightConfig& config);

/// How often earlier sights saw a surface at a point, and how often through it.
struct SightEvidence {
  int surface = 0, free = 0;
  bool came = false;  ///< first they saw through it and later a surface, and not only as they came nearer
  bool was_free() const { return came || (free >= 3 && free > 2 * surface); }
};

class SightLog {
 public:
  explicit SightLog(const SightConfig& config) : config_(config) {}

  /// Whether the rig has moved, or stood, enough since the last sight kept.
  bool is_due(Time time, const Vector3d& p_W) const;
  /// Keeps the sight where one is due.
  void add(Sight sight);
  SightEvidence evidence(const Vector3d& p_W, Time before) const;
  const SightConfig& config() const { return config_; }
  std::size_t size() const { return sights_.size(); }

 private:
  SightConfig config_;
  std::deque<Sight> sights_;
};

}  // namespace pllit
