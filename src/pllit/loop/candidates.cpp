// Which earlier places a place may be the same as.
#include <algorithm>
#include <cmath>

#include "pllit/loop/loop_closer.hpp"

namespace pllit {
namespace {

/// Largest standard deviation of the position in the plane.
double position_sigma_m(const UncertainMotion& motion) {
  return std::sqrt(
      std::max(0.0, motion.covariance.bottomRightCorner<3, 3>().selfadjointView<Eigen::Lower>().eigenvalues()[2]));
}

}  // namespace

std::vector<LoopCloser::Candidate> LoopCloser::candidates(const Anchor& here) const {
  const CandidateConfig& config = config_.candidates;
  std::vector<Candidate> near, alike;
  for (std::size_t i = 0; i < anchors_.size(); ++i) {
    const Anchor& there = anchors_[i];
    const LoopKeyframe& earlier = keyframes_[static_cast<std::size_t>(there.keyframe)];
    if (keyframes_[static_cast<std::size_t>(here.keyframe)].way_m - earlier.way_m < config.min_way_m) break;
    const UncertainMotion motion = expected(there.keyframe, here.keyframe);
    const double distance_m = motion.T_a_b.translation().norm();
    const double farthest_m = config.radius_m + plausible_m(there.keyframe, here.keyframe);
    if (distance_m > farthest_m) continue;
    const Candidate candidate{i, FoundBy::radius, distance_m, align(there.descriptor, here.descriptor)};
    if (distance_m <= std::min(farthest_m, config.radius_m + 3.0 * position_sigma_m(motion))) near.push_back(candidate);
    if (candidate.alignment.score >= config.min_score) alike.push_back(candidate);
  }
  std::ranges::stable_sort(near, {}, &Candidate::distance_m);
  std::ranges::stable_sort(alike, {}, [](const Candidate& c) { return -c.alignment.score; });
  std::vector<Candidate> chosen;
  const auto choose = [&](const std::vector<Candidate>& from, FoundBy found_by, int most) {
    for (const Candidate& candidate : from) {
      if (static_cast<int>(chosen.size()) >= most) return;
      const auto same_place_again = [&](const Candidate& other) {
        return other.found_by == found_by &&
               std::max(other.anchor, candidate.anchor) - std::min(other.anchor, candidate.anchor) <= 3;
      };
      if (std::ranges::any_of(chosen, same_place_again)) continue;
      chosen.push_back(candidate);
      chosen.back().found_by = found_by;
    }
  };
  choose(near, FoundBy::radius, std::max(1, config.tried - 1));  // leaves one for where drift hides the place
  choose(alike, FoundBy::descriptor, config.tried);
  return chosen;
}

SearchWindow LoopCloser::window_for(const Anchor& here, const Candidate& candidate) const {
  constexpr double descriptor_reach_m = 7.0, descriptor_reach_rad = 0.12, most_m = 12.0, most_rad = 0.3;
  const Anchor& there = anchors_[candidate.anchor];
  if (candidate.found_by == FoundBy::descriptor)
    return {{Eigen::Vector2d::Zero(), candidate.alignment.yaw_rad}, descriptor_reach_m, descriptor_reach_rad};
  const LoopKeyframe &earlier = keyframes_[static_cast<std::size_t>(there.keyframe)],
                     &later = keyframes_[static_cast<std::size_t>(here.keyframe)];
  const UncertainMotion motion = expected(there.keyframe, here.keyframe);
  const SE3 T_a_b = pose_from(levelled(earlier.up_I), Vector3d::Zero()) * motion.T_a_b *
                    pose_from(levelled(later.up_I).inverse(), Vector3d::Zero());
  const double turn_sigma_rad = std::sqrt(motion.covariance.topLeftCorner<3, 3>().trace());
  return {in_plane(T_a_b), std::min(most_m, 1.5 + 3.0 * position_sigma_m(motion)),
          std::min(most_rad, 0.05 + 3.0 * turn_sigma_rad)};
}

}  // namespace pllit
