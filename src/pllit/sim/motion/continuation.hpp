// Drives that go on where a recorded one ends, and drives made up from nothing.
#pragma once

#include <cstdint>

#include "pllit/state/trajectory.hpp"

namespace pllit {

struct ContinuationConfig {
  double length_m = 0.0;  ///< of the whole path, along its positions
  enum class Way {
    new_area,  ///< the same drive again, turned and moved to where no part of it comes near what was driven before
    revisit    ///< back to the start, then the same drive at the same place again
  } way = Way::new_area;
  double bend_radius_m = 35.0;
  double speed_mps = 8.0;     ///< on the connecting road
  double clearance_m = 40.0;  ///< of a new area, between the drives' centre lines
};

/// `path`, then as often as needed a connecting road (bend, straight, bend; heights and tilt pass over smoothly) and
/// the same drive again, cut to the wanted length. The connecting road may cross what was driven before. For rigs that
/// move along x of I; `path` is at least a second long and not at rest all the time.
Trajectory continued(const Trajectory& path, const ContinuationConfig& config);

struct StreetDrive {
  std::uint64_t seed = 1;
  double length_m = 1000.0;
  double speed_mps = 10.0;  ///< on straights; bends are taken at no more than 2 m/s2 to the side
};

/// A drive through streets that never meet themselves: straights of 60 to 200 m and bends of 15 to 60 m radius, on the
/// plane z = 0 of W, x of I forwards, poses at 10 Hz.
Trajectory street_drive(const StreetDrive& config);

}  // namespace pllit
