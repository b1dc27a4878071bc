#include "pllit/slam/health.hpp"

#include <format>

namespace pllit {
namespace {

/// The minimum that a match missed.
std::string missed_minimum(const FrameFacts& facts, const HealthConfig& config) {
  if (facts.inliers < config.min_inliers)
    return std::format("{} points fit the map; at least {} must", facts.inliers, config.min_inliers);
  return std::format("{} of {} points fit the map; at least {:.0f} % must", facts.inliers, facts.candidates,
                     100.0 * config.min_inlier_share);
}

}  // namespace

std::string_view name_of(HealthState state) {
  switch (state) {
    case HealthState::initialising:
      return "initialising";
    case HealthState::good:
      return "good";
    case HealthState::degraded:
      return "degraded";
    case HealthState::lost:
      return "lost";
  }
  return "unknown";
}

bool match_accepted(const NormalEquations& sums, const HealthConfig& config) {
  return sums.inliers >= config.min_inliers && sums.inliers >= config.min_inlier_share * sums.candidates;
}

Health assess(const FrameFacts& facts, const HealthConfig& config) {
  Health health{.state = HealthState::good, .reasons = {}};
  const auto mark = [&health](HealthState state, std::string reason) {
    health.state = std::max(health.state, state);
    health.reasons.push_back(std::move(reason));
  };
  const double share = facts.candidates > 0 ? static_cast<double>(facts.inliers) / facts.candidates : 0.0;
  if (facts.map_restarted)
    mark(HealthState::lost,
         std::format("{} scans in a row did not match; the map was begun anew", config.restart_after));
  if (facts.since_match_s > config.silent_lost_s)
    mark(HealthState::lost, std::format("no matched scan for {:.1f} s", facts.since_match_s));
  if (facts.speed_mps > config.max_speed_mps)
    mark(HealthState::lost, std::format("speed {:.0f} m/s is impossible", facts.speed_mps));

  if (facts.longest_imu_gap_s > facts.allowed_imu_gap_s)
    mark(HealthState::degraded, std::format("no IMU data for {:.2f} s", facts.longest_imu_gap_s));
  if (!facts.has_scan && facts.since_match_s > config.silent_degraded_s)
    mark(HealthState::degraded, std::format("LiDAR silent for {:.1f} s", facts.since_match_s));
  if (facts.image.correction > config.max_correction)
    mark(HealthState::degraded,
         std::format("images pull the pose away from the LiDAR's, {:.0f} times as hard as their noise explains; check "
                     "rig.camera (T_I_C, delay_s, intrinsics_px)",
                     facts.image.correction));
  if (facts.map_empty) return health;
  if (facts.has_scan && !facts.matched)
    mark(HealthState::degraded, "scan not matched: " + missed_minimum(facts, config));
  if (!facts.matched) return health;
  if (facts.localizability.degenerate > 0 && !facts.image.holds)
    mark(HealthState::degraded, "LiDAR does not observe " + describe_degeneracy(facts.localizability));
  if (share < config.low_inlier_share)
    mark(HealthState::degraded, std::format("only {:.0f} % of the points fit the map", 100.0 * share));
  if (facts.residual_rms_m > config.max_residual_m)
    mark(HealthState::degraded, std::format("residuals of {:.2f} m", facts.residual_rms_m));
  return health;
}

}  // namespace pllit
