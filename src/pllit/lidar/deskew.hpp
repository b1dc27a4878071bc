// Backward propagation of a scan to its end: motion during the sweep is taken out of the points.
#pragma once

#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sensor/rig.hpp"
#include "pllit/state/propagation.hpp"

namespace pllit {

/// Points in the IMU frame at one instant; the vectors have equal length.
struct PointCloud {
  Time reference;
  std::vector<Vector3f> points_I;  ///< m
  std::vector<float> intensity;
};

/// The scan's points between the LiDAR's minimum and maximum range, moved to where they would have been measured at the
/// path's end. Points earlier than the path continue its first motion backwards.
PointCloud deskew(const LidarScan& scan, const MotionPath& path, const SE3& T_I_L, const LidarModel& lidar);

}  // namespace pllit
