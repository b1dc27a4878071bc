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
  double turn_rad = 3e-5;   ///< likewise, rad per square root of a metre
  double imu_factor = 1.5;  ///< an IMU may be so many times noisier than promised: counts where it alone leads
};

/// Where the doubt about a pose comes from; covariances of (theta, p) in W.
struct PoseDoubt {
  Matrix6 match = Matrix6::Zero();       ///< of the pose against the map around the robot
  Matrix6 drift = Matrix6::Zero();       ///< of that map against the origin
  Matrix3d reckoned = Matrix3d::Zero();  ///< of shifts that no scan places, against where they were placed last

  Matrix6 total() const;
};

/// The filter measures poses against the map, and the map was built from poses.
/// Each scan hands its pose error on to the part of the map that it adds, so the
/// map's own error walks: this follows the covariance of that walk.
class MapDrift {
 public:
  explicit MapDrift(const DriftConfig& config) : config_(config) {}

  /// The robot has moved to p_W: an error in the map's heading becomes one in position.
  void move_to(const Vector3d& p_W);
  /// A frame's estimate. Along `unobserved` (directions of motion in W, orthonormal columns) it was not placed against
  /// the map: the filter's covariance there counts from where it was placed last. Once it is placed again, the map has
  /// inherited it. `image_holds`: it was an image that led there, not the IMU alone.
  void place(const Estimate& posterior, const Eigen::Matrix3Xd& unobserved, bool image_holds);
  /// The scan of the frame placed last has added `new_share` (0 to 1) of what it saw to the map.
  void add_scan(double new_share);
  /// The map is begun anew at this estimate: all of its pose error is the new map's.
  void restart(const Estimate& estimate);

  const PoseDoubt& doubt() const { return doubt_; }

 private:
  DriftConfig config_;
  PoseDoubt doubt_;
  /// Of what was reckoned, what placing again has not yet handed to the map.
  Matrix3d not_inherited_ = Matrix3d::Zero();
  Vector3d p_W_ = Vector3d::Zero();
};

/// Carries a pose covariance in (theta, p) of W from one place to another under a common rotation.
Matrix6 carried(const Matrix6& covariance_W, const Vector3d& displacement_W);
/// Covariance of the pose of b seen from a, (theta, p) in W, where b's position minus a's is `displacement_W`.
Matrix6 relative_covariance(const PoseDoubt& a, const PoseDoubt& b, const Vector3d& displacement_W);
/// The filter's pose covariance, with theta in W instead of I.
Matrix6 pose_covariance_W(const Estimate& estimate);

}  // namespace pllit
