// How the images of a camera are tied to the state: what calibration and clocks leave open of it is estimated.
#pragma once

#include "pllit/state/nav_state.hpp"

namespace pllit {

/// Order of the mount's errors: (theta, p) of T_I_C, right perturbation, of the delay and of the depth stretch.
namespace mount_index {
inline constexpr int theta = 0, p = 3, delay = 6, depth = 7, size = 8;
}
using MountVector = Eigen::Matrix<double, mount_index::size, 1>;
using MountMatrix = Eigen::Matrix<double, mount_index::size, mount_index::size>;

struct CameraMount {
  SE3 T_I_C = SE3::Identity();
  double delay_s = 0.0;  ///< of the exposure after the time that the image is taken to be of
  /// LiDAR ranges are too short for this camera by this share: slanting surfaces are measured too near, and a focal
  /// length that is too long looks the same to a rig that moves ahead.
  double depth_stretch = 0.0;
};

CameraMount boxplus(const CameraMount& mount, const MountVector& error);
MountVector boxminus(const CameraMount& a, const CameraMount& b);

/// Where I was when an image was exposed, and what becomes of errors.
struct Exposure {
  SE3 T_W_I;
  Eigen::Matrix<double, 6, 9> J_state;  ///< of its pose to the state's (theta, p, v), the first nine
  Vector6 J_delay;                      ///< and to the mount's delay
};

/// `state`: at the image's time. `rate_I`: how the rig turns there, rad/s. Holds for delays of milliseconds.
Exposure exposure(const NavState& state, double delay_s, const Vector3d& rate_I);

}  // namespace pllit
