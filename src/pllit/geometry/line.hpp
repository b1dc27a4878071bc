// Straight lines in space by Pluecker coordinates.
#pragma once

#include <Eigen/Core>

#include "pllit/geometry/lie.hpp"

namespace pllit {

/// A line of unit direction d and moment n = p x d for any point p on it (the paper's "Spatiotemporal Explicit
/// Structural Constraints"), in the frame that its name tells: line_W.
struct Line3 {
  Vector3d moment = Vector3d::Zero();  ///< m
  Vector3d direction = Vector3d::UnitX();

  static Line3 through(const Vector3d& p, const Vector3d& direction) {
    const Vector3d d = direction.normalized();
    return {p.cross(d), d};
  }
  /// The point of the line that is nearest to the origin.
  Vector3d nearest_to_origin() const { return direction.cross(moment); }
  double distance_m(const Vector3d& p) const { return (p - nearest_to_origin()).cross(direction).norm(); }
};

/// line_A of a line_B.
inline Line3 operator*(const SE3& T_A_B, const Line3& line_B) {
  const Matrix3d R = T_A_B.rotation();
  const Vector3d d = R * line_B.direction;
  return {R * line_B.moment + T_A_B.translation().cross(d), d};
}

}  // namespace pllit
