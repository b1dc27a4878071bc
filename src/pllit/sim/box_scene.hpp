// A box scene with everything that moves and measures in it.
#pragma once

#include "pllit/sim/boxes/scenes.hpp"
#include "pllit/sim/boxes/spinning_lidar.hpp"
#include "pllit/sim/config.hpp"
#include "pllit/sim/motion/imu.hpp"

namespace pllit {

struct BoxScene {
  PlanesWorld world;
  Motion motion;
  Rig rig;  ///< as the estimator knows it, and as it is
  ImuModel imu;
  SpinningLidar lidar;
};

/// For a configuration whose scene is a box. A hand-held rig with a LiDAR over the IMU.
BoxScene box_scene(const SimConfig& config);

}  // namespace pllit
