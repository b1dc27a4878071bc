// Carries the correction of keyframes over to everything in between.
#pragma once

#include <span>
#include <vector>

#include "pllit/loop/keyframe.hpp"
#include "pllit/state/table.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

/// Where keyframes went: T_M_I for what the odometry called T_O_I.
struct MovedKeyframe {
  Time time;
  SE3 T_O_I, T_M_I;
};

/// Corrects a pose of the odometry: as its keyframes before and after were, in proportion to the time between; before
/// the first and after the last, as that one. With no keyframes, nothing changes.
class Correction {
 public:
  explicit Correction(std::vector<MovedKeyframe> keyframes) : keyframes_(std::move(keyframes)) {}

  SE3 pose_M(Time time, const SE3& T_O_I) const;
  /// map -> odom of REP-105 at that pose: T_M_O = T_M_I T_I_O.
  SE3 T_M_O(Time time, const SE3& T_O_I) const { return pose_M(time, T_O_I) * T_O_I.inverse(); }
  Trajectory corrected(const Trajectory& odometry) const;

 private:
  std::vector<MovedKeyframe> keyframes_;
};

}  // namespace pllit
