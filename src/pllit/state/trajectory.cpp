#include "pllit/state/trajectory.hpp"

#include <algorithm>

namespace pllit {

std::optional<SE3> pose_at(const Trajectory& trajectory, Time time, Duration max_gap) {
  const auto after = std::ranges::lower_bound(trajectory, time, {}, &StampedPose::time);
  if (after == trajectory.end()) return std::nullopt;
  if (after->time == time) return after->T_W_I;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = after - 1;
  const Duration gap = after->time - before->time;
  if (gap > max_gap) return std::nullopt;
  const double s = to_seconds(time - before->time) / to_seconds(gap);
  const SO3 R_before = before->T_W_I.asSO3(), R_after = after->T_W_I.asSO3();
  const SO3 rotation = R_before * exp_so3(s * log_so3(R_before.inverse() * R_after));
  return pose_from(rotation, (1.0 - s) * before->T_W_I.translation() + s * after->T_W_I.translation());
}

double path_length_m(const Trajectory& trajectory) {
  double length = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i)
    length += (trajectory[i].T_W_I.translation() - trajectory[i - 1].T_W_I.translation()).norm();
  return length;
}

}  // namespace pllit
