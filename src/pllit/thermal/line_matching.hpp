// Lines of two images that are one edge, and the points that lie on them.
#pragma once

#include <vector>

#include "pllit/geometry/camera.hpp"
#include "pllit/thermal/keyframe.hpp"

namespace pllit {

struct LineMatchConfig {
  double on_line_px = 3.0;  ///< the paper's delta_line: how far off a line a point may be
  int least_shared = 2;     ///< matched points on both
  /// Shared points squared over the fewer matched points of either line (after AirSLAM's rule).
  double least_share = 0.8;
  double turned_deg = 15.0;                ///< lines that share points may differ so much from the predicted direction
  double alike_deg = 4.0, alike_px = 5.0;  ///< lines that share too few points: from the predicted line, whose
  double least_overlap = 0.5;              ///< part, of the shorter one, that lies side by side is at least this
  double depth_near_px = 10.0;             ///< points this near to a line tell its depth
};

/// For each line the points on it, ascending.
using PointsOnLines = std::vector<std::vector<int>>;

/// Distance of a point from a line's segment: across it where the foot of the perpendicular lies on the segment, or
/// beyond an end by no more than `beyond_px`; otherwise negative.
float distance_on_line(const Eigen::Vector2f& point_px, const LineSegment& line, float beyond_px);

PointsOnLines points_on_lines(const Features& features, const LineMatchConfig& config);

/// Lines of a keyframe and of the image now that are the best for each other: by the matched points that lie on both,
/// and where these are too few, by direction, distance and overlap with where the pose predicts the keyframe's line,
/// for lines with points of known depth. T_C_K: from the keyframe's camera to the camera now. LineMatch::keyframe stays
/// 0.
std::vector<LineMatch> match_lines(const Keyframe& keyframe, const Features& now, const PointsOnLines& on_lines_now,
                                   const std::vector<PointMatch>& points, const SE3& T_C_K, const Camera& camera,
                                   const LineMatchConfig& config);

/// Sets line_px of matches that lie on both lines of a matched pair: the larger of both distances, of the nearest such
/// pair.
void mark_anchored(std::vector<PointMatch>& points, const std::vector<LineMatch>& lines, const Features& reference,
                   const Features& now, const LineMatchConfig& config);

}  // namespace pllit
