// The clock offset between IMU and LiDAR, from the rig's own turning.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/slam/config.hpp"

namespace pllit {

/// Rotation of the rig from one scan to the next, in I, as the LiDAR alone sees it.
struct LidarRotation {
  Time from, to;     ///< middles of the two sweeps, LiDAR clock
  Vector3d angle_I;  ///< rad
};

/// Matches each scan to those before it without any IMU data. Scans that do not match are left out.
std::vector<LidarRotation> lidar_rotations(std::span<const LidarScan> scans, const Rig& rig, const Config& config);

struct TimeOffset {
  bool found = false;
  double offset_s = 0.0;      ///< add it to the LiDAR's stamps to get IMU time (the key rig.lidar.delay_s)
  double residual_rps = 0.0;  ///< rms of what is left between the two rates at that offset
  std::string reason;         ///< why it was not found
};

/// The offset at which the gyroscope's mean rate between two scans agrees best with the LiDAR's, within +-`range_s`.
TimeOffset estimate_time_offset(std::span<const ImuSample> imu, std::span<const LidarRotation> rotations,
                                double range_s = 0.5);

}  // namespace pllit
