// LiDARs that can be bought, as their data sheets have them.
#pragma once

#include <string>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/sim/world/lidar_patterns.hpp"
#include "pllit/sim/world/lidar_unit.hpp"

namespace pllit {

/// A LiDAR with its errors. Angles are full ones, at 1/e2 of the power.
struct RayLidar {
  std::string name;
  BeamPattern pattern;
  double min_range_m = 0.0, max_range_m = 100.0;
  double range_sigma_m = 0.0;   ///< along the beam, normal
  double range_step_m = 0.0;    ///< resolution of the range as written; 0: as computed
  double beam_sigma_rad = 0.0;  ///< the true beam against the reported one, to the left and upwards, normal
  double divergence_left_rad = 0.0, divergence_up_rad = 0.0;
  double range_10_m =
      0.0;  ///< at which a surface that reflects 10 % and faces the beam is seen nine times in ten; 0: all is seen
  double pulse_m = 0.5;           ///< returns nearer each other than this, half the pulse's length, are one
  bool strongest_return = false;  ///< of several returns the strongest is reported, else the first
  float counts_at_white =
      255.0F;  ///< intensity as written of a surface that reflects everything and faces the beam; 0 to 255
  UnitTolerance tolerance{};  ///< how far units lie apart
  LidarUnit unit{};           ///< which one this is: in models, one without errors of its own
};

/// The pattern alone: no noise, no divergence, every surface seen at every range.
RayLidar without_errors(RayLidar lidar);

/// Numbers from the makers' manuals and data sheets; where these are silent, the comment at the number says what was
/// assumed.
RayLidar pandar_xt32();
RayLidar velodyne_vlp16();
RayLidar velodyne_hdl64e();
RayLidar livox_horizon();
RayLidar livox_mid360();

/// "xt32", "vlp16", "hdl64e", "horizon" or "mid360"; an input error else.
Expected<RayLidar> lidar_model(const std::string& name);

}  // namespace pllit
