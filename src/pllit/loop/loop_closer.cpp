#include "pllit/loop/loop_closer.hpp"

#include <algorithm>
#include <cmath>
#include <format>

namespace pllit {
namespace {

constexpr double kDegree = M_PI / 180.0;

double way_gap(const LoopKeyframe& a, const LoopKeyframe& b) { return std::abs(b.way_m - a.way_m); }

}  // namespace

void LoopCloser::add(LoopKeyframe keyframe) {
  keyframes_.push_back(std::move(keyframe));
  add_to_graph(keyframes_.size() - 1);
  const double reach_m = config_.candidates.reach_m;
  while (keyframes_.back().way_m >= next_anchor_m_ + reach_m) {
    const auto at = std::ranges::lower_bound(keyframes_, next_anchor_m_, {}, &LoopKeyframe::way_m);
    look_from(static_cast<std::size_t>(at - keyframes_.begin()));
    next_anchor_m_ += config_.candidates.anchor_m;
  }
}

void LoopCloser::finish() {
  while (!keyframes_.empty() && keyframes_.back().way_m >= next_anchor_m_) {
    const auto at = std::ranges::lower_bound(keyframes_, next_anchor_m_, {}, &LoopKeyframe::way_m);
    look_from(static_cast<std::size_t>(at - keyframes_.begin()));
    next_anchor_m_ += config_.candidates.anchor_m;
  }
  if (accepted() == 0) return;
  const PoseGraph graph = whole_graph();
  const RobustSolution solution = optimised_robustly(graph);
  poses_M_ = solution.poses_M;
  std::size_t loop = 0;
  for (LoopRecord& record : records_)
    if (record.accepted && solution.loop_weights[loop++] == 0.0) {
      record.accepted = false;
      record.reason = "disagrees with the whole graph";
    }
}

int LoopCloser::accepted() const { return static_cast<int>(std::ranges::count(records_, true, &LoopRecord::accepted)); }

std::size_t LoopCloser::bytes() const {
  std::size_t bytes = anchors_.capacity() * sizeof(Anchor) + records_.capacity() * sizeof(LoopRecord) +
                      keyframes_.capacity() * (sizeof(LoopKeyframe) + sizeof(UncertainMotion) + sizeof(SE3));
  for (const LoopKeyframe& keyframe : keyframes_) bytes += keyframe.cloud.bytes();
  return bytes;
}

void LoopCloser::look_from(std::size_t keyframe) {
  const Submap submap = submap_around(keyframe);
  const Anchor here{static_cast<int>(keyframe), describe(submap.columns)};
  bool found = false;
  for (const Candidate& candidate : candidates(here)) {
    if (found && candidate.found_by == FoundBy::descriptor) break;  // the way back is known already
    records_.push_back(tried(here, submap, candidate));
    found |= records_.back().reason.empty();
  }
  anchors_.push_back(here);
  if (found) count_agreement();
}

Submap LoopCloser::submap_around(std::size_t keyframe) const {
  const double way_m = keyframes_[keyframe].way_m, reach_m = config_.candidates.reach_m;
  const auto first = std::ranges::lower_bound(keyframes_, way_m - reach_m, {}, &LoopKeyframe::way_m);
  const auto last = std::ranges::upper_bound(keyframes_, way_m + reach_m, {}, &LoopKeyframe::way_m);
  const auto index = [&](auto at) { return static_cast<std::size_t>(at - keyframes_.begin()); };
  return make_submap(keyframes_, index(first), index(last) - 1, keyframe, config_.keyframes.voxel_m,
                     config_.keyframes.range_m);
}

LoopRecord LoopCloser::tried(const Anchor& here, const Submap& submap, const Candidate& candidate) const {
  const Anchor& there = anchors_[candidate.anchor];
  const LoopKeyframe &earlier = keyframes_[static_cast<std::size_t>(there.keyframe)],
                     &later = keyframes_[static_cast<std::size_t>(here.keyframe)];
  LoopRecord record{.earlier = there.keyframe,
                    .later = here.keyframe,
                    .earlier_time = earlier.time,
                    .later_time = later.time,
                    .found_by = candidate.found_by,
                    .distance_m = candidate.distance_m,
                    .score = candidate.alignment.score};
  record.registration = register_submaps(submap_around(static_cast<std::size_t>(there.keyframe)), submap,
                                         window_for(here, candidate), config_.registration);
  const SE3 T_Ha_Ia = pose_from(levelled(earlier.up_I), Vector3d::Zero());
  const SE3 T_Hb_Ib = pose_from(levelled(later.up_I), Vector3d::Zero());
  record.T_earlier_later = T_Ha_Ia.inverse() * record.registration.T_a_b * T_Hb_Ib;
  const Matrix6 turned = adjoint(T_Hb_Ib.inverse());
  record.covariance = turned * record.registration.covariance * turned.transpose();
  const UncertainMotion guess = expected(record.earlier, record.later);
  record.squared_against_odometry = squared_difference(guess, {record.T_earlier_later, record.covariance});
  record.against_odometry_m = (guess.T_a_b.translation() - record.T_earlier_later.translation()).norm();
  record.reason = refusal(record);
  return record;
}

std::string LoopCloser::refusal(const LoopRecord& record) const {
  constexpr double most_tilt_rad = 3.0 * kDegree;
  if (std::string reason = pllit::refusal(record.registration, config_.registration); !reason.empty()) return reason;
  const Vector3d up_a = record.registration.T_a_b.rotation().col(2);
  if (std::acos(std::clamp(up_a.z(), -1.0, 1.0)) > most_tilt_rad) return "tilted against gravity";
  if (record.against_odometry_m > plausible_m(record.earlier, record.later))
    return std::format("odometry never drifts that far: {:.1f} m", record.against_odometry_m);
  const double minutes = std::chrono::duration<double>(record.later_time - record.earlier_time).count() / 60.0;
  const double turned_rad =
      difference(expected(record.earlier, record.later).T_a_b, record.T_earlier_later).head<3>().norm();
  if (turned_rad > (2.0 + config_.candidates.turn_deg_per_min * minutes) * kDegree)
    return std::format("odometry never turns that far: {:.1f} deg", turned_rad / kDegree);
  return "";
}

void LoopCloser::count_agreement() {
  const double from_m =
      keyframes_[static_cast<std::size_t>(records_.back().later)].way_m - config_.consistency.window_m;
  std::vector<std::size_t> window;  // what was verified lately
  for (std::size_t k = 0; k < records_.size(); ++k)
    if ((records_[k].accepted || records_[k].reason.empty()) &&
        keyframes_[static_cast<std::size_t>(records_[k].later)].way_m >= from_m)
      window.push_back(k);
  bool changed = false;
  const bool first = accepted() == 0;
  for (const std::size_t seed : window)
    if (!records_[seed].accepted) changed |= accept(seed, window);
  if (!changed) return;
  if (first) rebuild_graph();  // by now it is known what the first verticals were worth
  graph_->update(2);
  poses_M_ = graph_->poses_M();
}

bool LoopCloser::accept(std::size_t seed, std::span<const std::size_t> window) {
  std::vector<LoopRecord> loops;
  for (const std::size_t k : window) loops.push_back(records_[k]);
  const auto at = static_cast<std::size_t>(std::ranges::find(window, seed) - window.begin());
  std::vector<std::size_t> agreeing;
  for (const std::size_t k : agreeing_set(loops, at, odometry_, odometry_factor_, config_.consistency.max_squared))
    agreeing.push_back(window[k]);
  LoopRecord& record = records_[seed];
  record.agreeing = static_cast<int>(agreeing.size());
  const bool expected_by_odometry = record.squared_against_odometry <= config_.consistency.max_squared;
  if (record.agreeing < (expected_by_odometry ? config_.consistency.agreeing : config_.consistency.agreeing_against))
    return false;
  if (!expected_by_odometry) follow_drift(agreeing);
  for (const std::size_t k : agreeing) {
    if (records_[k].accepted) continue;
    records_[k].accepted = true;
    records_[k].agreeing = record.agreeing;
    records_[k].reason = expected_by_odometry ? "fits the odometry" : "agrees with others against the odometry";
    graph_->add_loop({records_[k].earlier, records_[k].later, records_[k].T_earlier_later, records_[k].covariance});
    if (!last_loop_ || records_[k].later >= records_[*last_loop_].later) last_loop_ = k;
  }
  return true;
}

void LoopCloser::follow_drift(const std::vector<std::size_t>& agreeing) {
  constexpr double degrees_of_freedom = 6.0;
  std::vector<double> squared;
  for (const std::size_t k : agreeing)
    if (!records_[k].accepted) squared.push_back(records_[k].squared_against_odometry);
  std::ranges::nth_element(squared, squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2));
  odometry_factor_ *= std::max(1.0, squared[squared.size() / 2] / degrees_of_freedom);
  rebuild_graph();
}

UncertainMotion LoopCloser::expected(int earlier, int later) const {
  const auto by_odometry = [this](int from, int to) {
    UncertainMotion motion = odometry_.between(from, to);
    motion.covariance *= odometry_factor_;
    return motion;
  };
  UncertainMotion motion = by_odometry(earlier, later);
  if (last_loop_) {
    const LoopRecord& loop = records_[*last_loop_];
    const UncertainMotion over_loop = by_odometry(earlier, loop.earlier) *
                                      UncertainMotion{loop.T_earlier_later, loop.covariance} *
                                      by_odometry(loop.later, later);
    if (over_loop.covariance.trace() < motion.covariance.trace()) motion.covariance = over_loop.covariance;
  }
  motion.T_a_b = poses_M_[static_cast<std::size_t>(earlier)].inverse() * poses_M_[static_cast<std::size_t>(later)];
  return motion;
}

double LoopCloser::way_between(int earlier, int later) const {
  const auto at = [this](int k) -> const LoopKeyframe& { return keyframes_[static_cast<std::size_t>(k)]; };
  const double along_m = way_gap(at(earlier), at(later));
  if (!last_loop_) return along_m;
  const LoopRecord& loop = records_[*last_loop_];
  return std::min(along_m, way_gap(at(earlier), at(loop.earlier)) + way_gap(at(loop.later), at(later)));
}

double LoopCloser::plausible_m(int earlier, int later) const {
  return config_.candidates.drift_m + config_.candidates.drift_share * way_between(earlier, later);
}

void LoopCloser::add_to_graph(std::size_t k) {
  const LoopKeyframe& keyframe = keyframes_[k];
  odometry_.append(keyframe.T_O_I, keyframe.step_covariance);
  const int pose = static_cast<int>(k);
  if (!graph_) graph_.emplace(keyframe.T_O_I, 0.1);
  if (k > 0) {
    UncertainMotion step = odometry_.between(pose - 1, pose);
    graph_->add_step({pose - 1, pose, step.T_a_b, odometry_factor_ * keyframe.step_covariance});
  }
  graph_->add_vertical({pose, keyframe.up_I, vertical_sigma_rad(k)});
  graph_->update();
  poses_M_.push_back(graph_->last_pose_M());
}

/// Soon after the start the odometry learns the accelerometer's bias, and with it where up is in its own frame: what
/// was said before then was as far off as that has moved since.
double LoopCloser::vertical_sigma_rad(std::size_t k) const {
  constexpr double kLearned_m = 200.0;  // drift does not tilt the frame by much on so short a way
  const auto up_O = [&](const LoopKeyframe& keyframe) { return Vector3d(keyframe.T_O_I.rotation() * keyframe.up_I); };
  const auto after =
      std::ranges::upper_bound(keyframes_, keyframes_[k].way_m + kLearned_m, {}, &LoopKeyframe::way_m) - 1;
  const double moved_rad = std::acos(std::clamp(up_O(keyframes_[k]).dot(up_O(*after)), -1.0, 1.0));
  return std::hypot(keyframes_[k].up_sigma_rad, config_.gravity_sigma_deg * kDegree, moved_rad);
}

void LoopCloser::rebuild_graph() {
  const PoseGraph whole = whole_graph();
  graph_.emplace(whole.guesses_M.front(), whole.tilt_sigma_rad);
  for (const RelativePose& step : whole.odometry) graph_->add_step(step);
  for (const RelativePose& loop : whole.loops) graph_->add_loop(loop);
  for (const Upright& vertical : whole.verticals) graph_->add_vertical(vertical);
  graph_->update();
}

PoseGraph LoopCloser::whole_graph() const {
  PoseGraph graph{.guesses_M = poses_M_, .odometry = {}, .loops = {}, .verticals = {}};
  for (int k = 0; k < odometry_.size(); ++k) {
    const LoopKeyframe& keyframe = keyframes_[static_cast<std::size_t>(k)];
    if (k > 0)
      graph.odometry.push_back(
          {k - 1, k, odometry_.between(k - 1, k).T_a_b, odometry_factor_ * keyframe.step_covariance});
    graph.verticals.push_back({k, keyframe.up_I, vertical_sigma_rad(static_cast<std::size_t>(k))});
  }
  for (const LoopRecord& record : records_)
    if (record.accepted)
      graph.loops.push_back({record.earlier, record.later, record.T_earlier_later, record.covariance});
  return graph;
}

}  // namespace pllit
