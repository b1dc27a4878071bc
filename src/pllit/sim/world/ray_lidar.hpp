// A LiDAR on a moving rig in a place, pulse by pulse.
#pragma once

#include <cstdint>
#include <functional>

#include "pllit/base/arena.hpp"
#include "pllit/sensor/measurements.hpp"
#include "pllit/sim/world/lidar_models.hpp"
#include "pllit/sim/world/ray_caster.hpp"

namespace pllit {

/// What a LiDAR scans, and from where.
struct LidarRun {
  const Place& place;
  RayCaster& caster;  ///< of that place; is moved along
  std::function<SE3(Time)> T_W_L;
  Time start;  ///< of the motion: scan 0 begins, and the actors' time is 0
  std::uint64_t seed = 0;
};

/// Scan `index` with every pulse sent from the rig's pose at its own time; actors move in steps of 5 ms,
/// and where none moves, things appear in steps of 25 ms. Where the pulses beside it, or above and below it, lie on
/// other surfaces than a pulse does, it is split into three or five rays inside its divergence, so that edges give
/// mixed points; elsewhere a slanting surface stretches it (lidar_unit.hpp). Intensity is what the sensor would write:
/// whole counts of reflectivity times cosine of incidence, range compensated. Textures do not vary it. The same seed
/// gives the same bytes, whatever the number of threads. Every point has its ring.
LidarScan simulate_scan(const RayLidar& lidar, const LidarRun& run, std::int64_t index, Arena& arena);

}  // namespace pllit
