// A view of map, way and findings that the reader turns with mouse or finger.
#pragma once

#include <span>
#include <string>

#include "pllit/state/anomaly.hpp"
#include "pllit/state/table.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

struct View3dConfig {
  std::size_t most_points = 40000;  ///< evenly thinned to so many: seven bytes each
  double above_way_m = 0.7;         ///< what lies higher above the way is hidden at first: ceilings
};

/// A canvas with its data and the script that draws them; nothing is loaded from elsewhere. The field `intensity` of
/// the map in pseudo-colour from its 2nd to its 98th percentile (grey where it has none), the way in white, alarms as
/// numbered rings. Empty for an empty map.
std::string view3d(const PointTable& map, const Trajectory& trajectory, std::span<const Anomaly> alarms,
                   const View3dConfig& config = {});

}  // namespace pllit
