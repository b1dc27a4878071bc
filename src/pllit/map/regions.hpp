// What visits show of named regions, and how that goes on from visit to visit.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/map/radiometry.hpp"
#include "pllit/state/region.hpp"
#include "pllit/state/table.hpp"

namespace pllit {

struct RegionsConfig {
  double voxel_m = 0.1;  ///< maps of two visits lie on each other to a few centimetres
  int images = 6;        ///< of a surface, at least
  int limit_voxels = 4;  ///< must reach a limit, or all where there are fewer: a single voxel is noise
  /// With which the temperatures of the maps were found: a region's own emissivity takes the place of theirs.
  Radiometry baseline_radiometry{}, visit_radiometry{};
};

/// Brings an intensity that a visit saw at a place to the baseline's scale; nothing where it cannot.
using BringIntensity = std::function<std::optional<double>(const Vector3d& p_W, double intensity)>;

/// A visit's readings, one for each region. Both maps as ThermalMap::table gives them and in the baseline's W.
std::vector<RegionReading> region_readings(const PointTable& baseline, const PointTable& visit,
                                           const BringIntensity& bring, std::span<const Region> regions,
                                           const RegionsConfig& config = {});

/// What the baseline itself shows: the first point of every trend.
std::vector<RegionReading> baseline_readings(const PointTable& baseline, std::span<const Region> regions,
                                             const RegionsConfig& config = {});

/// A number that tells one baseline's map from every other: a digest (FNV-1a) of its points and what is normal there.
std::uint64_t digest_of(const PointTable& baseline);

struct TimedValue {
  Time time;
  double value = 0.0;
};

struct RegionTrend {
  double per_day = 0.0;
  int visits = 0;
  double days = 0.0;  ///< from the first to the last
};

/// Robust slope (Theil and Sen). Nothing for fewer than three visits, or within less than an hour.
std::optional<RegionTrend> trend_of(std::span<const TimedValue> values);

}  // namespace pllit
