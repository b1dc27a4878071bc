// Which directions a scan does not observe, and an update that leaves those to the IMU.
#pragma once

#include <Eigen/Core>
#include <string>

#include "pllit/lidar/plane_residuals.hpp"

namespace pllit {

struct DegeneracyConfig {
  /// A direction counts as observed where its information exceeds that of noisy normals by this factor ...
  double min_over_noise = 2.0;
  /// ... and is at least this share of what it would be were every plane to face it (for turns a tenth of it).
  double min_share = 2e-5;
  /// A direction that was not observed in the scan before must exceed both by this factor to count as observed again.
  double release = 3.0;
  /// Share of the way that such a direction moves, each scan, towards the one that this scan shows.
  double follow = 0.03;
};

/// Directions that a scan does not observe: one a column, unit vectors in metres, (theta x lever in W, p in W).
using DegenerateDirections = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// How well a scan holds each direction.
struct Localizability {
  /// Information along x, y, z (translation, then rotation, in
  /// W) as a share of the whole; 1/3 where planes face all ways.
  Vector6 axis_share = Vector6::Zero();
  double weakest_share = 0.0;       ///< of the weakest direction, whichever way it points
  int degenerate = 0;               ///< number of directions that are not observed, 0 to 6
  Vector6 worst = Vector6::Zero();  ///< the first of them
};

struct ObservedEquations {
  NormalEquations sums;
  Localizability localizability;
  DegenerateDirections unobserved = DegenerateDirections(6, 0);
};

/// Takes the unobserved directions out of the normal equations of a scan linearised at attitude `R_W_I`: there the
/// posterior equals the prior. Directions are eigenvectors of the 6 x 6 pose block with the rotation scaled by the
/// scan's mean lever arm, so that all are in metres. The directions `held`, those of the scan before, stay the same
/// until they are clearly observed: noise in the normals moves the weakest direction from scan to scan, and were it
/// followed, the scans together would seem to observe it.
ObservedEquations observed_part(const PlaneEquations& equations, const SO3& R_W_I, const DegenerateDirections& held,
                                const DegeneracyConfig& config);

/// The first unobserved direction in words, for reports: "translation along (0.99, 0.05, 0.01)".
std::string describe_degeneracy(const Localizability& localizability);

}  // namespace pllit
