#include "pllit/loop/correction.hpp"

#include <algorithm>

namespace pllit {

SE3 Correction::pose_M(Time time, const SE3& T_O_I) const {
  if (keyframes_.empty()) return T_O_I;
  const auto as_moved = [&](const MovedKeyframe& keyframe) {
    return keyframe.T_M_I * (keyframe.T_O_I.inverse() * T_O_I);
  };
  const auto after = std::ranges::upper_bound(keyframes_, time, {}, &MovedKeyframe::time);
  if (after == keyframes_.begin()) return as_moved(keyframes_.front());
  if (after == keyframes_.end()) return as_moved(keyframes_.back());
  const SE3 a = as_moved(*(after - 1)), b = as_moved(*after);
  const double share = to_seconds(time - (after - 1)->time) / to_seconds(after->time - (after - 1)->time);
  const SO3 turn = a.asSO3() * exp_so3(share * log_so3(a.asSO3().inverse() * b.asSO3()));
  return pose_from(turn, (1.0 - share) * a.translation() + share * b.translation());
}

Trajectory Correction::corrected(const Trajectory& odometry) const {
  Trajectory corrected;
  corrected.reserve(odometry.size());
  for (const StampedPose& pose : odometry) corrected.push_back({pose.time, pose_M(pose.time, pose.T_W_I)});
  return corrected;
}

}  // namespace pllit
