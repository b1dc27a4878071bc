#include "pllit/sim/motion/arcs.hpp"

#include <limits>
#include <numbers>

namespace pllit {
namespace {

/// `angle` as a turn to one side (+1 left, -1 right): from 0 to almost a full turn, with that sign.
double turn_towards(double side, double angle) {
  constexpr double kFull = 2.0 * std::numbers::pi;
  double turn = std::fmod(side * angle, kFull);
  if (turn < 0.0) turn += kFull;
  if (turn > kFull - 1e-9) turn = 0.0;
  return side * turn;
}

/// Infinitely long where the circles overlap.
ArcStraightArc connection_by(const PlanePose& from, const PlanePose& to, double radius_m, double first_side,
                             double second_side) {
  const Eigen::Vector2d first_centre = from.position + first_side * radius_m * left_of(from.heading_rad);
  const Eigen::Vector2d second_centre = to.position + second_side * radius_m * left_of(to.heading_rad);
  const Eigen::Vector2d between = second_centre - first_centre;
  const double cross_m = (first_side - second_side) * radius_m;  // 0 for an outer tangent, 2 radii for an inner one
  const double squared = between.squaredNorm() - cross_m * cross_m;
  if (squared < 0.0)
    return {.start = from, .radius_m = radius_m, .straight_m = std::numeric_limits<double>::infinity()};
  const double straight_m = std::sqrt(squared);
  const double heading_rad = std::atan2(between.y(), between.x()) + std::atan2(cross_m, straight_m);
  return {from, radius_m, turn_towards(first_side, heading_rad - from.heading_rad), straight_m,
          turn_towards(second_side, to.heading_rad - heading_rad)};
}

}  // namespace

PlanePose along_arc(const PlanePose& from, double curvature_pm, double s) {
  const double turn = curvature_pm * s;
  // sin(x/2)/(x/2) keeps its digits where the arc is nearly straight.
  const double chord_m = std::abs(turn) < 1e-6 ? s : s * std::sin(0.5 * turn) / (0.5 * turn);
  return {from.position + chord_m * direction(from.heading_rad + 0.5 * turn), from.heading_rad + turn};
}

double ArcStraightArc::length_m() const {
  return radius_m * (std::abs(first_turn_rad) + std::abs(second_turn_rad)) + straight_m;
}

PlanePose ArcStraightArc::at(double s) const {
  const double first_m = radius_m * std::abs(first_turn_rad);
  const double first_curvature = std::copysign(1.0 / radius_m, first_turn_rad);
  if (s <= first_m) return along_arc(start, first_curvature, s);
  const PlanePose after_turn = along_arc(start, first_curvature, first_m);
  if (s <= first_m + straight_m) return along_arc(after_turn, 0.0, s - first_m);
  return along_arc(along_arc(after_turn, 0.0, straight_m), std::copysign(1.0 / radius_m, second_turn_rad),
                   s - first_m - straight_m);
}

ArcStraightArc connection(const PlanePose& from, const PlanePose& to, double radius_m) {
  ArcStraightArc best = connection_by(from, to, radius_m, 1.0, 1.0);
  for (const auto& [first_side, second_side] : {std::pair{1.0, -1.0}, {-1.0, 1.0}, {-1.0, -1.0}}) {
    const ArcStraightArc other = connection_by(from, to, radius_m, first_side, second_side);
    if (other.length_m() < best.length_m()) best = other;
  }
  return best;
}

}  // namespace pllit
