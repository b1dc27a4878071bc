// Poses over time, and how to read one between two samples.
#pragma once

#include <optional>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/geometry/lie.hpp"

namespace pllit {

struct StampedPose {
  Time time;
  SE3 T_W_I;
};

/// Poses with strictly ascending times.
using Trajectory = std::vector<StampedPose>;

/// Pose at `time` by interpolation (rotation along the geodesic, position linearly); nothing outside the trajectory or
/// inside a gap longer than `max_gap`.
std::optional<SE3> pose_at(const Trajectory& trajectory, Time time, Duration max_gap);

/// Length of the path in metres.
double path_length_m(const Trajectory& trajectory);

}  // namespace pllit
