// Straight edges without a network.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "pllit/thermal/features.hpp"

namespace pllit {

struct LineConfig {
  double scale = 0.6;           ///< of the image that is searched: thermal edges are blurred over pixels
  double least_length_px = 25;  ///< after merging
  int most = 80;                ///< the longest
  double merge_deg = 3.0;       ///< pieces of one edge differ in direction by less
  double merge_px = 1.5;        ///< and lie on one straight line to this
  double merge_gap_px = 12.0;   ///< with no wider gap between them
};

/// Segments found by LSD (von Gioi et al. 2010, OpenCV's) with pieces of one edge merged, longest first. Along a
/// segment from start to end the same side is the brighter one. grey: CV_8UC1.
std::vector<LineSegment> line_segments(const cv::Mat& grey, const LineConfig& config);

/// The merging alone: pieces that continue or cover each other become one; what is then shorter than the least length
/// is dropped.
std::vector<LineSegment> merged(std::vector<LineSegment> segments, const LineConfig& config);

}  // namespace pllit
