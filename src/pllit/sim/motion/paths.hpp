// Operations on paths: trajectories that a motion is yet to be fitted to.
#pragma once

#include "pllit/sim/motion/ground.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

/// The same poses, `factor` times as fast; the first time stays.
Trajectory sped_up(const Trajectory& path, double factor);

/// Left and right exchanged, of W and of I: mirrored in the planes y = 0. Rotations stay rotations, and what drove
/// forwards along x still does.
Trajectory mirrored(const Trajectory& path);

/// The same way back: from the last position to the first, turned round by half a turn about z of I, so that what drove
/// forwards along x still does. Between the same first and last time.
Trajectory reversed(const Trajectory& path);

/// The path up to a duration or a length; all of it where it is shorter. A path that is not empty keeps its first pose.
Trajectory cut_to_duration(const Trajectory& path, double duration_s);
Trajectory cut_to_length(const Trajectory& path, double length_m);

/// The path seen from another world: T_V_W times each pose.
Trajectory moved(const Trajectory& path, const SE3& T_V_W);

/// How a rig stands on the ground.
enum class Stance {
  upright,  ///< heights follow the ground, rotations stay: a person
  tilted    ///< roll and pitch follow the slope, the heading of x of I stays: a car
};
/// The path above `ground`, everywhere height_m over it. Rotations of tilted paths have x forwards and z up.
Trajectory on_ground(const Trajectory& path, const Ground& ground, double height_m, Stance stance);

}  // namespace pllit
