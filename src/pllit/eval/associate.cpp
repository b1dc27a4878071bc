#include "pllit/eval/associate.hpp"

#include <algorithm>
#include <format>
#include <string>

namespace pllit {
namespace {

std::string span_of(const Trajectory& trajectory) {
  if (trajectory.empty()) return "is empty";
  return std::format("runs from {:.3f} s to {:.3f} s", to_seconds(trajectory.front().time),
                     to_seconds(trajectory.back().time));
}

std::ptrdiff_t samples_within(const Trajectory& trajectory, Time first, Time last) {
  return std::ranges::count_if(trajectory, [&](const StampedPose& p) { return first <= p.time && p.time <= last; });
}

/// Whether pairs are taken at the truth's samples; on a tie they are.
bool at_truth_samples(const Trajectory& truth, const Trajectory& estimate, AssociationTimes times) {
  if (times == AssociationTimes::truth || truth.empty() || estimate.empty()) return true;
  const Time first = std::max(truth.front().time, estimate.front().time);
  const Time last = std::min(truth.back().time, estimate.back().time);
  return samples_within(truth, first, last) <= samples_within(estimate, first, last);
}

}  // namespace

Expected<std::vector<PosePair>> associate(const Trajectory& truth, const Trajectory& estimate,
                                          const AssociationConfig& config) {
  std::vector<PosePair> pairs;
  if (at_truth_samples(truth, estimate, config.times)) {
    for (const StampedPose& sample : truth)
      if (const auto pose = pose_at(estimate, sample.time, config.max_gap))
        pairs.push_back({sample.time, sample.T_W_I, *pose});
  } else {
    for (const StampedPose& sample : estimate)
      if (const auto pose = pose_at(truth, sample.time, config.max_gap))
        pairs.push_back({sample.time, *pose, sample.T_W_I});
  }
  if (pairs.empty())
    return input_error(
        std::format("no common time: the truth {}, the estimate {} (gaps over {} s are not bridged); are "
                    "both on one clock, in seconds?",
                    span_of(truth), span_of(estimate), to_seconds(config.max_gap)));
  return pairs;
}

}  // namespace pllit
