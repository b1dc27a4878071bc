#include "pllit/sim/world/pose_table.hpp"

namespace pllit {
namespace {

constexpr Duration kSpacing = std::chrono::microseconds(250);

}  // namespace

PoseTable::PoseTable(const std::function<SE3(Time)>& T_W_L, Time start, Time end) : start_(start) {
  const auto intervals = (end - start) / kSpacing + 1;
  for (std::int64_t i = 0; i <= intervals; ++i) {
    const SE3 pose = T_W_L(start + i * kSpacing);
    poses_.push_back({.R_W_L = pose.rotation(), .p_W = pose.translation()});
  }
}

PoseTable::Placed PoseTable::place(Time time, const Vector3d& direction_L) const {
  const Duration since = time - start_;
  const auto index = static_cast<std::size_t>(since / kSpacing);
  const double share = static_cast<double>((since % kSpacing).count()) / static_cast<double>(kSpacing.count());
  const Pose &before = poses_[index], &after = poses_[index + 1];
  const Vector3d mixed_W = (1.0 - share) * (before.R_W_L * direction_L) + share * (after.R_W_L * direction_L);
  return {.p_W = (1.0 - share) * before.p_W + share * after.p_W, .direction_W = mixed_W.normalized()};
}

}  // namespace pllit
