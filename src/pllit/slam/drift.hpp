// How far the map around the robot may have moved from the origin: odometry's uncertainty that the filter cannot see.
#pragma once

#include "pllit/state/nav_state.hpp"

namespace pllit {

struct DriftConfig {
  /// Variance of the match that new parts of the map inherit, as a multiple of the filter's: the errors of scans that
  /// follow each other are alike, so they add up faster than independent ones.
  double gain = 1.0;
  double shift_m =
      5e-4;  ///< what no scan knows of itself (calibration, rounding of surfaces): m per square root of a metre
  double turn_rad = 3e-5;  ///< likewise, rad per square root of a metre
};

/// The filter measures poses against the map, and the map was built from poses.
/// Each scan hands its pose error on to the part of the map that it adds, so the
/// map's own error walks: this is the covariance of that walk, in (theta, p) of W.
class MapDrift {
 public:
  explicit MapDrift(const DriftConfig& config) : config_(config) {}

  /// The robot has moved to p_W: an error in the map's heading becomes one in position.
  void move_to(const Vector3d& p_W);
  /// A scan with this pose estimate has added `new_share` (0 to 1) of what it saw to the map. Along `unobserved`
  /// (directions of motion in W, orthonormal columns) it was not placed against the map, so the filter's covariance
  /// there is not one against the map but counts from the origin already.
  void add_scan(const Estimate& posterior, double new_share, const Eigen::Matrix3Xd& unobserved);
  /// The map is begun anew at this estimate: all of its pose error is the new map's.
  void restart(const Estimate& estimate);

  const Matrix6& covariance_W() const { return covariance_W_; }

 private:
  DriftConfig config_;
  Matrix6 covariance_W_ = Matrix6::Zero();
  Vector3d p_W_ = Vector3d::Zero();
};

/// Carries a pose covariance in (theta, p) of W from one place to another under a common rotation.
Matrix6 carried(const Matrix6& covariance_W, const Vector3d& displacement_W);
/// The filter's pose covariance, with theta in W instead of I.
Matrix6 pose_covariance_W(const Estimate& estimate);

}  // namespace pllit
