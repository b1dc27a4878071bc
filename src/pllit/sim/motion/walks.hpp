// How the rig is carried: along a lane at walking pace, or shaken where it stands.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "pllit/sim/motion/motion.hpp"

namespace pllit {

/// Where one may walk: a rectangle with rounded corners around the origin of W, on flat or inclined ground. An infinite
/// straight_x_m gives a straight line along x from the origin. Motions stay within kLaneHalfWidth_m of its centre line,
/// to either side, and of height_m.
struct Lane {
  double straight_x_m = 0.0;  ///< length of the straight parts along x
  double straight_y_m = 0.0;
  double corner_radius_m = 0.0;
  double height_m = 1.3;                            ///< of the IMU above the ground
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< the ground is z = slope . (x, y)
};
inline constexpr double kLaneHalfWidth_m = 0.35;

/// Length of one lap.
double perimeter_m(const Lane& lane);

/// Motions start at rest: every derivative is exactly zero until rest_s.
struct MotionConfig {
  std::uint64_t seed = 1;
  double duration_s = 30.0;
  double rest_s = 2.0;
  double speed_mps = 1.0;    ///< mean speed of a walk
  double glance_rad = 0.35;  ///< how far one looks to either side of the way
};

/// Laps of the lane as a person with the rig in the hands makes them: starting anywhere on it, in either sense, at a
/// speed that varies by 15 %, looking where one goes and a little around, with the sway and bob of steps.
Motion walk_along(const Lane& lane, const MotionConfig& config);

/// Where a walker is on the way: the position on the ground and the heading there.
struct Foothold {
  Vector3d ground_W = Vector3d::Zero();
  double heading_rad = 0.0;
};
/// A walk as above along any way of a given length, height_m above it; it slows down to stand at the end. The length
/// decides the duration, not config.duration_s.
Motion walk_way(const std::function<Foothold(double s_m)>& way, double length_m, double height_m,
                const MotionConfig& config);

/// Stands somewhere on the lane and shakes the rig about all axes, at rates that peak between 2 and 3 rad/s.
Motion fast_shake(const Lane& lane, const MotionConfig& config);

}  // namespace pllit
