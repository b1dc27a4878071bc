// Where poses put a keyframe's points in the image now.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pllit/geometry/camera.hpp"
#include "pllit/thermal/keyframe.hpp"

namespace pllit {

/// Where a point may show: on the segment between two pixels, which are one where its depth is known.
struct Prediction {
  Eigen::Vector2f far_px = Eigen::Vector2f::Zero(), near_px = Eigen::Vector2f::Zero();

  /// From the nearest place of the segment to a pixel.
  Eigen::Vector2f off(const Eigen::Vector2f& at) const;
};

/// Rays through a keyframe's points, unit, in its camera's frame K.
std::vector<Vector3d> rays_of(const Keyframe& keyframe, const Camera& camera);

/// One a point; nothing where the camera cannot see it. T_C_K: from the keyframe's camera to the camera now. nearest_m:
/// least distance of points whose depth is not known.
std::vector<std::optional<Prediction>> predictions_of(const Keyframe& keyframe, std::span<const Vector3d> rays_K,
                                                      const SE3& T_C_K, const Camera& camera, double nearest_m);

/// The pose nearest to T_C_K that agrees with most matches of points whose depth is known, found by reweighted least
/// squares (Tukey) of their reprojection with a weak prior; T_C_K itself where there are fewer than 10. It serves to
/// tell right matches from wrong ones: what the filter makes of the matches is another matter.
SE3 agreed_pose(const Keyframe& keyframe, std::span<const Vector3d> rays_K, std::span<const PointMatch> matches,
                const Features& now, const SE3& T_C_K, const Camera& camera);

}  // namespace pllit
