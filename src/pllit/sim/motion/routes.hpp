// Walks through scenes that are built to fit them: what a place needs to know of its way is stated here.
#pragma once

#include "pllit/sim/motion/walks.hpp"

namespace pllit {

/// The lane of an inspection: a loop of 8 m by 6 m around the origin of W, on the ground z = 0.
Lane inspection_lane();

struct InspectionWalk {
  std::uint64_t seed = 1;
  double laps = 2.5;
  double speed_mps = 0.7;
};
/// Laps of the inspection lane, hand-held, looking around by 50 deg to either side.
Motion inspection_walk(const InspectionWalk& config);

struct CorridorWalk {
  std::uint64_t seed = 1;
  double length_m = 100.0;
  double speed_mps = 1.1;
};
/// Along x from the origin of W to (length, 0), a turn to the left of 0.5 m radius, and back along y = 1 m, 1.3 m above
/// z = 0. The walk keeps within -0.4 and 1.4 m of y and 0.9 m beyond the ends of x.
Motion corridor_walk(const CorridorWalk& config);

/// A stairwell with half-turn landings, all to the left. The first flight climbs along x from the origin of W, the
/// second climbs back along y = well_m to x = 0, the third is above the first, and so on. Level ways lead there and on.
struct Stairs {
  int flights = 4;
  int steps = 10;  ///< in each flight
  double rise_m = 0.17;
  double going_m = 0.28;
  double well_m = 1.4;     ///< between the centre lines of two flights
  double landing_m = 0.5;  ///< walked straight on before and after each flight
  double level_m = 0.0;    ///< walked straight on before the first landing and after the last

  double flight_run_m() const { return steps * going_m; }
  double flight_rise_m() const { return steps * rise_m; }
};

struct StairClimb {
  std::uint64_t seed = 1;
  Stairs stairs{};
  double speed_mps = 0.5;  ///< on the map
};
/// Up all flights in the rhythm of the steps and half a turn on every landing; the IMU is 1.3 m above the
/// line through the steps' edges.
Motion stair_climb(const StairClimb& config);

}  // namespace pllit
