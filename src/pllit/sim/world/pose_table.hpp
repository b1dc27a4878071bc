// A motion sampled so finely that straight lines between the samples will do.
#pragma once

#include <functional>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/geometry/lie.hpp"

namespace pllit {

/// Poses every 0.25 ms over some time. Between them positions and rotation matrices change evenly: at 50 m/s2 and 600
/// rad/s2 that is within 0.5 um and 0.005 mrad of the motion.
class PoseTable {
 public:
  struct Placed {
    Vector3d p_W;          ///< the sensor
    Vector3d direction_W;  ///< unit
  };

  /// From `start` to at least `end`.
  PoseTable(const std::function<SE3(Time)>& T_W_L, Time start, Time end);

  /// A unit direction in L at `time`, which lies within the table.
  Placed place(Time time, const Vector3d& direction_L) const;

 private:
  struct Pose {
    Matrix3d R_W_L;
    Vector3d p_W;
  };
  Time start_;
  std::vector<Pose> poses_;
};

}  // namespace pllit
