// How far the map around the robot may have moved from the origin: odometry's uncertainty that the filter cannot see.
#pragma once

#include <array>

#include "pllit/state/nav_state.hpp"

namespace pllit {

struct DriftConfig {
  /// Variance of the match that a whole new map inherits, as a multiple of the filter's: the errors of scans that
  /// follow each other are alike, so what all of them add together is as far off as one.
  double gain = 1.0;
  /// What no scan knows of itself (rounding of surfaces, calibration that comes and goes), per square root of a metre.
  double shift_m = 5e-4, turn_rad = 3e-5;
  /// What is wrong with a LiDAR all the way long, one sigma: it measures longer or shorter by a share, and the angles
  /// of its field are wider or narrower, which shows as turns too far or too short into what it had not seen before.
  double scale_share = 5e-4, turn_share = 2e-3;
  double imu_factor = 1.5;  ///< an IMU may be so many times noisier than promised: counts where it alone leads
};

/// Where the doubt about a pose comes from; covariances of (theta, p) in W.
struct PoseDoubt {
  Matrix6 match = Matrix6::Zero();       ///< of the pose against the map around the robot
  Matrix6 drift = Matrix6::Zero();       ///< of that map against the origin
  Matrix3d reckoned = Matrix3d::Zero();  ///< of shifts that no scan places, against where they were placed last
  /// Errors (theta, p) in W that one sigma of scale and of turning too far make: the same fault in all poses.
  std::array<Vector6, 2> systematic{Vector6::Zero(), Vector6::Zero()};

  Matrix6 total() const;
};

/// The filter measures poses against the map, and the map was built from poses.
/// Each scan hands its pose error on to the part of the map that it adds, so the
/// map's own error walks: this follows the covariance of that walk, and what is wrong all the way long.
class MapDrift {
 public:
  explicit MapDrift(const DriftConfig& config) : config_(config) {}

  /// The robot has moved: an error in the map's heading becomes one in position.
  void move_to(const SE3& T_W_I);
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
  SE3 T_W_I_ = SE3::Identity();
  double turned_rad_ = 0.0;  ///< to the left, since the last scan was added
};

/// Carries a pose covariance in (theta, p) of W from one place to another under a common rotation.
Matrix6 carried(const Matrix6& covariance_W, const Vector3d& displacement_W);
/// Likewise a pose error.
Vector6 carried(const Vector6& error_W, const Vector3d& displacement_W);
/// Covariance of the pose of b seen from a, (theta, p) in W, where b's position minus a's is `displacement_W`.
Matrix6 relative_covariance(const PoseDoubt& a, const PoseDoubt& b, const Vector3d& displacement_W);
/// The filter's pose covariance, with theta in W instead of I.
Matrix6 pose_covariance_W(const Estimate& estimate);

}  // namespace pllit
