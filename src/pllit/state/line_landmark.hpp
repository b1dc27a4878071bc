// An explicit line of the map.
#pragma once

#include <cstdint>

#include "pllit/geometry/line.hpp"

namespace pllit {

/// Where the ray through a pixel of an observed line meets the near surface that owns the edge.
struct EdgePoint {
  Vector3d p_C = Vector3d::Zero();
  double sigma_ray_m = 0.0;     ///< standard deviation along the ray
  double sigma_across_m = 0.0;  ///< and across it, from the line's own error in the image
};

/// A straight edge of the world, fitted to LiDAR points. Its four degrees of freedom are the shifts of the points at
/// `centroid_W - half_length_m d` and `centroid_W + half_length_m d` across the line, along two unit vectors that are
/// normal to d: covariance is theirs, in the order (first end along u, first end along v, second end along u, along v).
struct LineLandmark {
  std::uint32_t id = 0;
  Line3 line_W;
  Vector3d centroid_W = Vector3d::Zero();
  double half_length_m = 0.0;
  Vector3d u_W = Vector3d::UnitY(), v_W = Vector3d::UnitZ();
  Eigen::Matrix4d covariance_m2 = Eigen::Matrix4d::Zero();
  int sightings = 0;
};

}  // namespace pllit
