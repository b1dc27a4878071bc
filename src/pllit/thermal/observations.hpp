// What an image says about the pose: the hand-over from feature tracking to the filter's residuals.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "pllit/state/line_landmark.hpp"

namespace pllit {

/// A point of an earlier keyframe seen again.
struct PointObservation {
  std::size_t keyframe = 0;     ///< index of the keyframe among the poses that the filter keeps
  Eigen::Vector3d p_K_m;        ///< the point in the camera frame of that keyframe, at its LiDAR depth
  double sigma_ray_m = 0.0;     ///< standard deviation of that depth, along the ray
  Eigen::Vector2d observed_px;  ///< in the image now, as seen (distorted)
  double sigma_px = 1.0;        ///< standard deviation of that, before weights
  double line_px = -1.0;        ///< distance to the matched line that it lies on in both images; negative: on none
};

/// A line of the map seen again.
struct LineObservation {
  std::size_t keyframe = 0;          ///< index of a keyframe that saw it, among the poses that the filter keeps
  LineLandmark line_K;               ///< in the camera frame of that keyframe
  Eigen::Vector2d start_px, end_px;  ///< of the segment in the image now, as seen (distorted)
};

/// Everything that one image offers to the update.
struct ImageObservations {
  Vector3d rate_I = Vector3d::Zero();  ///< how the rig turns at the image's time, rad/s
  std::vector<PointObservation> points;
  std::vector<LineObservation> lines;
};

}  // namespace pllit
