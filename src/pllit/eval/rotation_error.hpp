// Angles of a rotation error.
#pragma once

#include <cmath>
#include <numbers>

#include "pllit/geometry/lie.hpp"

namespace pllit {

inline double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// Angle of the whole rotation, 0 to 180 degrees.
inline double angle_deg(const SO3& rotation) { return degrees(log_so3(rotation).norm()); }

/// Turn of the x axis in the horizontal plane, -180 to 180 degrees, for a rotation written in a world whose z is up.
inline double yaw_deg(const SO3& rotation_W) {
  const Matrix3d R = rotation_W.rotation();
  return degrees(std::atan2(R(1, 0), R(0, 0)));
}

}  // namespace pllit
