// What holds for every scan that any decoder returns.
#pragma once

#include <algorithm>
#include <cstdlib>

#include "pllit/sensor/measurements.hpp"

namespace pllit::fuzz {

inline void require(bool holds) {
  if (!holds) std::abort();
}

inline void check_invariants(const LidarScan& scan) {
  require(scan.points_L.size() == scan.offsets.size() && scan.points_L.size() == scan.intensity.size());
  require(std::ranges::is_sorted(scan.offsets));
  require(scan.offsets.empty() || scan.offsets.front() == Duration{});
  require(std::ranges::all_of(
      scan.points_L, [](const Eigen::Vector3f& point) { return point.allFinite() && (point.array() != 0.0f).any(); }));
}

}  // namespace pllit::fuzz
