// The shortest way of two arcs and a straight between two headings on the plane.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace pllit {

struct PlanePose {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;  ///< counter-clockwise from x
};

inline Eigen::Vector2d direction(double heading_rad) { return {std::cos(heading_rad), std::sin(heading_rad)}; }
inline Eigen::Vector2d left_of(double heading_rad) { return {-std::sin(heading_rad), std::cos(heading_rad)}; }

/// An arc, a straight and an arc, of one radius; angles are positive to the left.
struct ArcStraightArc {
  PlanePose start;
  double radius_m = 1.0;
  double first_turn_rad = 0.0;
  double straight_m = 0.0;
  double second_turn_rad = 0.0;

  double length_m() const;
  /// Pose after s metres, s in [0, length].
  PlanePose at(double s) const;
};

/// The shortest of the four combinations of left and right turns (Dubins, "On curves of minimal length", American
/// Journal of Mathematics 1957, without the words of three arcs).
ArcStraightArc connection(const PlanePose& from, const PlanePose& to, double radius_m);

/// Where s metres along an arc of signed curvature (1/m, positive to the left) lead.
PlanePose along_arc(const PlanePose& from, double curvature_pm, double s);

}  // namespace pllit
