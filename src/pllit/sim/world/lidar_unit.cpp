#include "pllit/sim/world/lidar_unit.hpp"

#include <cmath>
#include <numbers>

#include "pllit/sim/random.hpp"
#include "pllit/sim/world/lidar_patterns.hpp"

namespace pllit {
namespace {

/// Full width at half height of a normal curve, and half of it, in standard deviations.
const double kHalfWidth = std::sqrt(2.0 * std::numbers::ln2), kFullWidth = 2.0 * kHalfWidth;

}  // namespace

Eigen::Vector2d LidarUnit::aside_rad(const Beam& beam) const {
  const double across = beam.direction_L.head<2>().norm();
  const double c = across > 0.0 ? beam.direction_L.x() / across : 1.0,
               s = across > 0.0 ? beam.direction_L.y() / across : 0.0;
  Eigen::Vector2d aside = c * bend_rad[0] + s * bend_rad[1] + (c * c - s * s) * bend_rad[2] + 2.0 * c * s * bend_rad[3];
  if (beam.line < line_rad.size()) aside.y() += line_rad[beam.line];
  return aside;
}

double LidarUnit::offset_m(const Beam& beam) const {
  return range_m + (beam.line < line_range_m.size() ? line_range_m[beam.line] : 0.0);
}

LidarUnit drawn_unit(const UnitTolerance& tolerance, std::size_t lines, Random& random) {
  LidarUnit unit;
  unit.range_m = tolerance.range_m * random.gaussian();
  // Four parts of equal weight make up the bend.
  for (Eigen::Vector2d& part : unit.bend_rad)
    for (double& angle : part) angle = 0.5 * tolerance.bend_rad * std::numbers::sqrt2 * random.gaussian();
  // Between a detector of peaks and one of half heights; makers do not say which.
  unit.leading_edge = random.uniform(0.3, 0.7);
  for (std::size_t line = 0; line < lines; ++line) {
    unit.line_range_m.push_back(tolerance.line_range_m * random.gaussian());
    unit.line_rad.push_back(tolerance.line_rad * random.gaussian());
  }
  return unit;
}

double slant_bias_m(double leading_edge, double pulse_m, double spread_m) {
  const double sigma_m = pulse_m / kFullWidth;
  return leading_edge * kHalfWidth * (std::sqrt(sigma_m * sigma_m + spread_m * spread_m) - sigma_m);
}

}  // namespace pllit
