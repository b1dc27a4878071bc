// Which directions a scan does not observe, and an update that leaves those to the IMU.
#pragma once

#include <Eigen/Core>
#include <string>

#include "pllit/lidar/plane_residuals.hpp"

namespace pllit {

struct DegeneracyConfig {
  /// A direction counts as observed where its information exceeds that of noisy normals by this factor ...
  double min_over_noise = 8.0;
  /// ... and is at least this share of what it would be were every plane to face it.
  double min_share = 0.004;
};

/// How well a scan holds each direction.
struct Localizability {
  /// Information along x, y, z (translation in W, then rotation in I) as a share of the whole; 1/3 where planes face all ways.
  Vector6 axis_share = Vector6::Zero();
  double weakest_share = 0.0;  ///< of the weakest direction, whichever way it points
  int degenerate = 0;          ///< number of directions that are not observed, 0 to 6
  Matrix6 degenerate_directions = Matrix6::Zero();  ///< first columns: unit vectors (theta in I x lever, p in W)
};

struct ObservedEquations {
  NormalEquations sums;
  Localizability localizability;
};

/// Takes the unobserved directions out of the normal equations: there the posterior equals the prior. Directions are the
/// eigenvectors of the 6 x 6 pose block with the rotation scaled by the scan's mean lever arm, so that all are in metres.
ObservedEquations observed_part(const PlaneEquations& equations, const DegeneracyConfig& config);

/// "forward/left/up" wording of the worst direction, for reports: e.g. "translation along (0.99, 0.05, 0.01)".
std::string describe_degeneracy(const Localizability& localizability);

}  // namespace pllit
