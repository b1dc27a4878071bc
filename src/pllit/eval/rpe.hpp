// Relative pose error: the drift over a given distance travelled, which no alignment touches.
#pragma once

#include <span>
#include <vector>

#include "pllit/eval/associate.hpp"
#include "pllit/state/nav_state.hpp"

namespace pllit {

/// One pair, for plots and for intervals of confidence.
struct RelativeSample {
  double distance_m = 0.0;  ///< travelled up to its first pose, along the matched truth
  double error_m = 0.0, percent = 0.0, yaw_deg = 0.0, rotation_deg = 0.0;
};

/// Over all pairs (i, j) whose path along the matched truth is `delta_m`: from every i the j nearest to it, kept where
/// the path differs by at most a tenth of delta. With E = (T_i^-1 T_j)_truth^-1 (T_i^-1 T_j)_estimate, the same as
/// `evo_rpe --all_pairs --pairs_from_reference --delta_unit m`.
struct RelativeError {
  double delta_m = 0.0;
  std::size_t pairs = 0;      ///< 0: the path is shorter than delta, or its samples lie too far apart; no figures then
  double rmse_m = 0.0;        ///< of the length of E's translation
  double percent = 0.0;       ///< root mean square of that length in percent of the pair's own path, close to delta
  double yaw_deg = 0.0;       ///< root mean square of E's turn about the z axis of the truth's world
  double rotation_deg = 0.0;  ///< root mean square of E's whole angle
  std::vector<RelativeSample> samples{};
};

/// The estimated motion between two matched poses against the true one, (theta, p) in V, p of the later position: what
/// the covariance of their relative pose (`relative_pose_covariance`) is about.
Vector6 motion_error_V(const PosePair& from, const PosePair& to);

/// Alignment of the pairs makes no difference.
RelativeError relative_error(std::span<const PosePair> pairs, double delta_m);

}  // namespace pllit
