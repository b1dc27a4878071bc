// Whether an estimate can be trusted, frame by frame, with the reasons.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pllit/lidar/degeneracy.hpp"
#include "pllit/slam/image_facts.hpp"

namespace pllit {

enum class HealthState { initialising, good, degraded, lost };
std::string_view name_of(HealthState state);

struct HealthConfig {
  int min_inliers = 60;            ///< fewer matched points: the scan does not count
  double min_inlier_share = 0.25;  ///< of the points that have a plane: likewise
  double low_inlier_share = 0.45;  ///< below this the match is doubtful: degraded
  double max_residual_m = 0.15;    ///< rms of the matched points; above: degraded
  double max_speed_mps = 60.0;     ///< faster than this cannot be: lost
  double silent_degraded_s = 0.3;  ///< without a matched scan for this long: degraded
  double silent_lost_s = 5.0;      ///< without a matched scan for this long: lost
  double max_correction = 10.0;    ///< images' correction of the LiDAR's pose over what is expected; above: degraded
  int restart_after = 10;          ///< scans in a row that do not match before the map is begun anew
};

/// What a frame showed.
struct FrameFacts {
  bool has_scan = false;
  bool matched = false;
  bool map_restarted = false;
  bool map_empty = false;  ///< the scan had nothing to match: the first one, or after a restart
  int points = 0, candidates = 0, inliers = 0, iterations = 0;
  double residual_rms_m = 0.0;
  double speed_mps = 0.0;
  double since_match_s = 0.0;
  double longest_imu_gap_s = 0.0;
  double allowed_imu_gap_s = 0.25;
  Localizability localizability;
  ImageFacts image;
};

struct Health {
  HealthState state = HealthState::initialising;
  std::vector<std::string> reasons;  ///< empty when good
};

/// Whether a scan's match may update the state.
bool match_accepted(const NormalEquations& sums, const HealthConfig& config);
/// Judges one frame.
Health assess(const FrameFacts& facts, const HealthConfig& config);

}  // namespace pllit
