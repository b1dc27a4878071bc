// Where exactly a keyframe's points show in the image now: their surroundings laid on it, to a fraction of a pixel.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>

#include "pllit/geometry/camera.hpp"
#include "pllit/thermal/keyframe.hpp"

namespace pllit {

struct AlignConfig {
  bool enabled = true;
  int half_px = 7;                 ///< a patch has 2 half_px + 1 pixels a side
  int most_steps = 12;             ///< of Gauss-Newton
  double settled_px = 0.03;        ///< a step that changes no more is the last one
  double gate_px = 3.0;            ///< from where the pose puts a point, at most
  double least_correlation = 0.8;  ///< of both patches
  double most_sigma_px = 0.5;      ///< of the place, along the worse direction, as the patches' differences tell
  double least_contrast = 2.0;     ///< standard deviation of a patch, grey
  double most_scale = 2.5;         ///< a surface shows so many times larger or smaller at most
};

/// What patches are compared in: the image, slightly blurred. grey: CV_8UC1.
cv::Mat image_for_alignment(const cv::Mat& grey);

/// Moves `at_px`, where the point is thought to show, to where the image now looks as the keyframe's does around its
/// point: inverse-compositional Gauss-Newton (Baker and Matthews, IJCV 2004) over the shift, whatever gain and bias lie
/// between both, with the patch drawn as the point's surface shows it from here (its plane from LiDAR depth). Nothing
/// where the patches do not agree, say too little along one direction, or run out of an image. Both images are
/// image_for_alignment(). T_C_K: from the keyframe's camera to the camera now.
std::optional<Eigen::Vector2f> aligned(const cv::Mat& now, const Keyframe& keyframe, std::size_t point,
                                       const Vector3d& ray_K, const Eigen::Vector2f& at_px, const SE3& T_C_K,
                                       const Camera& camera, const AlignConfig& config);

/// All points of known depth that show in the image now: aligned from where they were matched, or else from where the
/// pose puts them; those that were matched but cannot be aligned stay where their match is.
std::vector<PointTrack> tracked_points(const cv::Mat& now, const Features& features, const Keyframe& keyframe,
                                       std::span<const Vector3d> rays_K, std::span<const PointMatch> matches,
                                       const SE3& T_C_K, const Camera& camera, const AlignConfig& config);

}  // namespace pllit
