// An explicit line of the map.
#pragma once

#include <cstdint>

#include "pllit/geometry/line.hpp"

namespace pllit {

/// Where the ray through a pixel of an observed line meets the near surface that owns the edge.
struct EdgePoint {
  Vector3d p_C = Vector3d::Zero();
  double sigma_ray_m = 0.0;     ///< standard deviation along the ray
  double sigma_across_m = 0.0;  ///< and across it, of this point alone
  /// Where the whole line's error across itself in the image, one standard deviation, moves it on its surface.
  Vector3d slide_C_m = Vector3d::Zero();
};

/// A straight edge of the world, fitted to LiDAR points, in the frame that its name tells: line_W. Its four degrees of
/// freedom are the shifts of the points at `centroid - half_length_m d` and `centroid + half_length_m d` across the
/// line, along two unit vectors that are normal to d: covariance is theirs, in the order (first end along u, first end
/// along v, second end along u, along v).
struct LineLandmark {
  std::uint32_t id = 0;
  Line3 axis;
  Vector3d centroid = Vector3d::Zero();
  double half_length_m = 0.0;
  Vector3d u = Vector3d::UnitY(), v = Vector3d::UnitZ();
  Eigen::Matrix4d covariance_m2 = Eigen::Matrix4d::Zero();
  int sightings = 0;
};

/// line_A of a line_B.
inline LineLandmark operator*(const SE3& T_A_B, const LineLandmark& line_B) {
  const Matrix3d R_A_B = T_A_B.rotation();
  LineLandmark line_A = line_B;
  line_A.axis = T_A_B * line_B.axis;
  line_A.centroid = T_A_B.act(line_B.centroid);
  line_A.u = R_A_B * line_B.u;
  line_A.v = R_A_B * line_B.v;
  return line_A;
}

}  // namespace pllit
