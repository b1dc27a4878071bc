// Which features of the image now are those of the keyframes.
#pragma once

#include <span>

#include "pllit/base/arena.hpp"
#include "pllit/geometry/camera.hpp"
#include "pllit/thermal/alignment.hpp"
#include "pllit/thermal/keyframe.hpp"
#include "pllit/thermal/line_matching.hpp"

namespace pllit {

struct MatchConfig {
  double window_px = 16.0;     ///< how far from the predicted pixel a point is looked for
  double gate_px = 3.0;        ///< how far from where the pose puts it that most matches agree on
  double nearest_m = 1.0;      ///< a point whose depth is not known lies between this and infinity
  double most_distance = 1.0;  ///< of unit descriptors
  double ratio = 0.9;          ///< of the best distance to the second best in the window, at most
  double twin_px = 6.0;        ///< points nearer to the best one look like it and are no second best
  LineMatchConfig lines{};
  AlignConfig align{};
};

/// Matches by descriptor around where the poses predict each keyframe's points: points with depth near their
/// projection, others near the epipolar line's part for their possible depths. Matches are the best for both points,
/// pass the ratio test, and agree with the other matches of the keyframe on a pose near the predicted one. Lines
/// are matched through the points, and points that lie on matched lines in both images marked (the paper's
/// structure-anchored points). Points of known depth, matched or not, are then aligned with the image itself.
/// image_now: image_for_alignment() of the image, greys not calibrated; empty: nothing is aligned. T_W_C_now:
/// predicted. The keyframes' T_W_C: as estimated now.
Tracks match_to_keyframes(const Features& now, const cv::Mat& image_now, const SE3& T_W_C_now,
                          std::span<const Keyframe> window, const Camera& camera, const MatchConfig& config,
                          Arena& arena);

}  // namespace pllit
