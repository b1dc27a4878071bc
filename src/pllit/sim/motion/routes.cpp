#include "pllit/sim/motion/routes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pllit/sim/motion/arcs.hpp"

namespace pllit {
namespace {

using std::numbers::pi;
constexpr double kHeight_m = 1.3;

/// Height of a foot s metres along a flight of stairs: each step is climbed in the middle half of its going, which
/// leaves the steps' rhythm in the motion.
double climbed_m(const Stairs& stairs, double s) {
  const double steps = std::clamp(s / stairs.going_m, 0.0, static_cast<double>(stairs.steps));
  const double whole = std::floor(steps);
  const double x = std::clamp(2.0 * (steps - whole) - 0.5, 0.0, 1.0);
  const double stepwise = whole + x * x * (3.0 - 2.0 * x);
  // A body rises far more evenly than a foot.
  return stairs.rise_m * (0.8 * steps + 0.2 * stepwise);
}

/// s: from the first landing on, before which it is negative.
Foothold on_stairs(const Stairs& stairs, double s) {
  if (s < 0.0) return {{s - stairs.landing_m, 0.0, 0.0}, 0.0};
  const double flight_m = stairs.flight_run_m() + 2.0 * stairs.landing_m;
  const double turn_m = 0.5 * pi * stairs.well_m;
  const int flight = std::min(static_cast<int>(s / (flight_m + turn_m)), stairs.flights - 1);
  const double on_flight = s - flight * (flight_m + turn_m);
  const bool outward = flight % 2 == 0;
  const double start_x = outward ? -stairs.landing_m : stairs.flight_run_m() + stairs.landing_m;
  const PlanePose start{{start_x, outward ? 0.0 : stairs.well_m}, flight * pi};
  const bool last = flight == stairs.flights - 1;
  PlanePose at = along_arc(start, 0.0, last ? on_flight : std::min(on_flight, flight_m));
  // All turns go to the left: two flights and two landings make one round of the stairwell.
  if (on_flight > flight_m && !last) at = along_arc(at, 2.0 / stairs.well_m, on_flight - flight_m);
  const double height_m = flight * stairs.flight_rise_m() + climbed_m(stairs, on_flight - stairs.landing_m);
  return {{at.position.x(), at.position.y(), height_m}, at.heading_rad};
}

}  // namespace

Lane inspection_lane() {
  return {.straight_x_m = 5.0, .straight_y_m = 3.0, .corner_radius_m = 1.5, .height_m = kHeight_m};
}

Motion inspection_walk(const InspectionWalk& config) {
  const double length_m = config.laps * perimeter_m(inspection_lane());
  return walk_along(inspection_lane(), {.seed = config.seed,
                                        .duration_s = 2.0 + 1.0 + length_m / config.speed_mps,
                                        .rest_s = 2.0,
                                        .speed_mps = config.speed_mps,
                                        .glance_rad = 50.0 * pi / 180.0});
}

Motion corridor_walk(const CorridorWalk& config) {
  constexpr double kTurn_m = 0.5;
  const auto way = [&](double s) {
    const double turn_m = pi * kTurn_m;
    PlanePose at = along_arc({}, 0.0, std::min(s, config.length_m));
    if (s > config.length_m) at = along_arc(at, 1.0 / kTurn_m, std::min(s - config.length_m, turn_m));
    if (s > config.length_m + turn_m) at = along_arc(at, 0.0, s - config.length_m - turn_m);
    return Foothold{{at.position.x(), at.position.y(), 0.0}, at.heading_rad};
  };
  return walk_way(way, 2.0 * config.length_m + pi * kTurn_m, kHeight_m,
                  {.seed = config.seed, .speed_mps = config.speed_mps});
}

Motion stair_climb(const StairClimb& config) {
  const Stairs& stairs = config.stairs;
  const double flight_m = stairs.flight_run_m() + 2.0 * stairs.landing_m;
  const double length_m =
      2.0 * stairs.level_m + stairs.flights * flight_m + (stairs.flights - 1) * 0.5 * pi * stairs.well_m;
  return walk_way([&](double s) { return on_stairs(stairs, s - stairs.level_m); }, length_m, kHeight_m,
                  {.seed = config.seed, .speed_mps = config.speed_mps, .glance_rad = 0.2});
}

}  // namespace pllit
