// What the voxels of one anomaly come to.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

#include "pllit/map/watch.hpp"

namespace pllit {

/// Sums over the voxels of one anomaly.
struct Members {
  int all = 0, left = 0, hot = 0, known = 0, new_surfaces = 0, lasting = 0;
  int of_this_look = 0, still_shown = 0;  ///< first hot within seconds, but not just now; of these in the last images
  bool seen_hot_now = false;
  double change = 0.0, sigmas = 0.0, peak_change = 0.0, peak_sigmas = 0.0;
  double own_change = 0.0, own_sigmas = 0.0;  ///< of those that are no mere parts
  Eigen::AlignedBox3d box_W;

  void add(const WatchedVoxel& watched, Time now, double dwell_s) {
    ++all;
    left += watched.vacated ? 1 : 0;
    note_look(watched, now);
    if (!watched.hot) return;
    ++hot;
    known += !watched.new_surface && !watched.joined ? 1 : 0;
    new_surfaces += watched.new_surface && !watched.joined ? 1 : 0;
    lasting += watched.dwell_s() >= dwell_s ? 1 : 0;
    seen_hot_now = seen_hot_now || watched.last == now;
    const double in_sigmas = watched.change / watched.sigma;
    change += watched.change;
    sigmas += in_sigmas;
    if (!watched.joined) {
      own_change += watched.change;
      own_sigmas += in_sigmas;
    }
    peak_change = std::max(peak_change, static_cast<double>(watched.peak));
    peak_sigmas = std::max(peak_sigmas, static_cast<double>(watched.peak / watched.sigma));
    box_W.extend(watched.position_W);
  }

  void note_look(const WatchedVoxel& watched, Time now) {
    constexpr double kJustNow_s = 0.3, kOneLook_s = 2.0, kLastImages_s = 0.15;
    const double since_s = to_seconds(now - watched.since);
    if (since_s < kJustNow_s || since_s > kOneLook_s) return;
    ++of_this_look;
    still_shown += watched.hot && to_seconds(now - watched.last) < kLastImages_s ? 1 : 0;
  }
};

inline Members members_of(std::span<WatchedVoxel* const> parts, Time now, double dwell_s) {
  Members members;
  for (const WatchedVoxel* part : parts) members.add(*part, now, dwell_s);
  return members;
}

/// What came and is not seen any more where it was a moment ago walks on.
inline bool walks(const Members& members, double least_still) {
  return members.new_surfaces > members.known && members.still_shown < least_still * members.of_this_look;
}

}  // namespace pllit
