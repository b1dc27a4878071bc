// A spinning LiDAR on the moving rig, ray by ray.
#pragma once

#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sensor/rig.hpp"
#include "pllit/sim/boxes/planes_world.hpp"
#include "pllit/sim/motion/motion.hpp"
#include "pllit/sim/random.hpp"

namespace pllit {

/// Where a spinning LiDAR looks: all rings at once at each of the evenly spaced azimuths, counter-clockwise about z of
/// L from its x axis, one turn a period.
struct LidarPattern {
  std::vector<double> elevations_rad;
  int azimuth_steps = 0;
  Duration period{0};
};

/// 32 rings from -16 to 15 degrees, 2000 azimuths, 10 Hz: 640 000 rays a second.
LidarPattern ring32_pattern();
/// 16 rings from -15 to 15 degrees, 1000 azimuths, 10 Hz: for speed.
LidarPattern ring16_pattern();

/// A LiDAR with its errors. Range noise is normal along the ray. Beam noise turns the true ray against the reported one
/// by normal angles to the left and upwards. Returns outside the model's ranges are lost.
struct SpinningLidar {
  LidarPattern pattern;
  LidarModel model;
  SE3 T_I_L = SE3::Identity();
};

/// One turn that starts at `start`, each ray cast from the rig's pose at its own time. Intensity is 255 times
/// reflectivity times the cosine of incidence.
LidarScan simulate_scan(const SpinningLidar& lidar, const PlanesWorld& world, const Motion& motion, Time start,
                        Random random);

}  // namespace pllit
