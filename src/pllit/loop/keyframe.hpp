// A stretch of the way with what the LiDAR saw from it, in little memory.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/state/nav_state.hpp"

namespace pllit {

/// Points to half a centimetre in six bytes each.
class CompactCloud {
 public:
  CompactCloud() = default;
  /// Points beyond 327 m along an axis are dropped.
  explicit CompactCloud(const std::vector<Vector3f>& points);

  std::vector<Vector3f> points() const;
  std::size_t size() const { return centimetres_.size(); }
  std::size_t bytes() const { return centimetres_.capacity() * sizeof(centimetres_.front()); }

 private:
  std::vector<std::array<std::int16_t, 3>> centimetres_;
};

/// The frame O is the odometry's: smooth, and drifting.
struct LoopKeyframe {
  Time time{};
  SE3 T_O_I{};
  Matrix6 step_covariance = Matrix6::Zero();  ///< of the motion since the keyframe before: (theta, p) on its right
  Vector3d up_I = Vector3d::UnitZ();          ///< away from gravity
  double up_sigma_rad = 0.0;
  double way_m = 0.0;    ///< since the start
  CompactCloud cloud{};  ///< in I: what was seen since the keyframe before
};

/// One point for each voxel that holds any: their mean.
std::vector<Vector3f> thinned(const std::vector<Vector3f>& points, double voxel_m);

}  // namespace pllit
