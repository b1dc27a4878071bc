#include "pllit/slam/frame_table.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace pllit {
namespace {

std::string joined(const std::vector<std::string>& reasons) {
  std::string text;
  for (const std::string& reason : reasons) text += (text.empty() ? "" : "; ") + reason;
  return text;
}

}  // namespace

std::vector<std::string> health_columns() {
  return {"time_s",     "state",     "reasons",       "points",     "candidates",    "inliers",       "residual_m",
          "iterations", "speed_mps", "sigma_x_m",     "sigma_y_m",  "sigma_z_m",     "sigma_yaw_deg", "share_x",
          "share_y",    "share_z",   "weakest_share", "degenerate", "since_match_s", "imu_gap_s",     "image",
          "features",   "matches",   "anchored",      "lines",      "image_inliers", "misfit",        "correction",
          "grey_gain",  "grey_bias", "frame_ms"};
}

namespace {

/// What became of the frame's image, in a word or with the reason.
std::string image_word(const ImageFacts& image) {
  if (!image.seen) return "none";
  if (!image.refused.empty()) return image.refused;
  return image.used ? "used" : "too few matches";
}

}  // namespace

std::vector<FrameCell> health_row(const FrameEstimate& frame) {
  const FrameFacts& facts = frame.facts;
  const Vector6 sigma = frame.pose_covariance().diagonal().cwiseMax(0.0).cwiseSqrt();  // theta, p in W
  const auto count = [](int n) { return static_cast<std::int64_t>(n); };
  const Vector6& share = facts.localizability.axis_share;
  return {to_seconds(frame.posterior.mean.time),
          std::string(name_of(frame.health.state)),
          joined(frame.health.reasons),
          count(facts.points),
          count(facts.candidates),
          count(facts.inliers),
          facts.residual_rms_m,
          count(facts.iterations),
          facts.speed_mps,
          sigma[3],
          sigma[4],
          sigma[5],
          sigma[2] * 180.0 / M_PI,
          share[0],
          share[1],
          share[2],
          facts.localizability.weakest_share,
          count(facts.localizability.degenerate),
          facts.since_match_s,
          facts.longest_imu_gap_s,
          image_word(facts.image),
          count(facts.image.points),
          count(facts.image.matches),
          count(facts.image.anchored),
          count(facts.image.lines),
          count(facts.image.inliers),
          facts.image.misfit,
          facts.image.correction,
          facts.image.gain,
          facts.image.bias_grey,
          std::accumulate(frame.stage_ms.begin(), frame.stage_ms.end(), 0.0)};
}

std::vector<std::string> loop_columns() {
  return {"later_s", "earlier_s",  "found_by",    "distance_m",       "score",      "columns",  "overlap",  "matched",
          "rmse_m",  "own_rmse_m", "information", "odometry_squared", "odometry_m", "agreeing", "accepted", "reason"};
}

std::vector<FrameCell> loop_row(const LoopRecord& record) {
  const Registration& registration = record.registration;
  return {to_seconds(record.later_time),
          to_seconds(record.earlier_time),
          std::string(record.found_by == FoundBy::radius ? "radius" : "descriptor"),
          record.distance_m,
          record.score,
          registration.columns.score,
          registration.overlap,
          registration.matched,
          registration.rmse_m,
          registration.own_rmse_m,
          registration.information,
          record.squared_against_odometry,
          record.against_odometry_m,
          static_cast<std::int64_t>(record.agreeing),
          static_cast<std::int64_t>(record.accepted ? 1 : 0),
          record.accepted || !record.reason.empty() ? record.reason : "no other loop agrees"};
}

void move_points(PointTable& points, std::string_view field, Time start, const Correction& correction,
                 const Trajectory& odometry) {
  const std::vector<float>* times = find_field(points, field);
  assert(times);
  if (odometry.empty()) return;
  std::size_t frame = odometry.size();  // none yet
  SE3 T_M_O;
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    const Time time = start + from_seconds((*times)[i]);
    const auto after = std::ranges::lower_bound(odometry, time - std::chrono::milliseconds(5), {}, &StampedPose::time);
    const auto own = static_cast<std::size_t>(std::min(after, odometry.end() - 1) - odometry.begin());
    if (own != frame) {
      frame = own;
      T_M_O = correction.T_M_O(odometry[own].time, odometry[own].T_W_I);
    }
    points.points[i] = T_M_O.act(points.points[i].cast<double>()).cast<float>();
  }
}

PointTable MapRecorder::new_points(const FrameEstimate& frame) {
  if (!first_) first_ = frame.posterior.mean.time;
  const auto seconds = static_cast<float>(to_seconds(frame.posterior.mean.time - *first_));
  const std::vector<Vector3f> points_W = frame.points_W();

  PointTable table{.points = {}, .fields = {{"intensity", {}}, {"time", {}}}};
  if (frame.health.state == HealthState::lost ||
      (frame.facts.has_scan && !frame.facts.matched && !frame.facts.map_empty))
    return table;  // a pose that does not fit the map must not enter it
  for (const std::size_t i : fresh_.select(points_W, frame.posterior.mean.p_W)) {
    table.points.push_back(points_W[i]);
    table.fields[0].values.push_back(frame.cloud.intensity[i]);
    table.fields[1].values.push_back(seconds);
  }
  return table;
}

}  // namespace pllit
