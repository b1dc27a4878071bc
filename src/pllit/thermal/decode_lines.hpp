// Straight edges out of the network's line map.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/types.hpp>
#include <vector>

#include "pllit/thermal/features.hpp"
#include "pllit/thermal/network_maps.hpp"

namespace pllit {

struct LineDecoding {
  double least_attraction = 0.3;  ///< of a cell that takes part
  double grow_deg = 12.0;         ///< cells of one line name directions that differ by less
  double grow_px = 1.5;           ///< and feet that lie on it to this
  double least_junction = 0.15;
  double match_along_px = 6.0, match_across_px = 3.0;  ///< an end this near to a junction is moved there
  double least_support = 0.5;                          ///< mean agreement of the field along the segment, 0 to 1
  double least_length_px = 16.0;
  double merge_deg = 3.0, merge_px = 2.0, merge_gap_px = 8.0;  ///< pieces of one line
  int most = 100;                                              ///< the best: by support and length
};

struct Junction {
  Eigen::Vector2f at_px = Eigen::Vector2f::Zero();
  float score = 0.0F;
};

/// Cells that are the best junction among their eight neighbours, best first.
std::vector<Junction> decode_junctions(const MapView& lines, const cv::Size& image, double least_score);

/// Segments, best first: cells whose feet lie on one line are gathered from the surest on; the line through their feet,
/// between the ends that the cells near them name, is moved to junctions where there are some, checked along its length
/// against the field and freed of near duplicates. Only the `image` in the upper left of the map counts.
std::vector<LineSegment> decode_lines(const MapView& lines, const cv::Size& image, const LineDecoding& config);

/// How well the field agrees with a segment, 0 to 1: over places along it, attraction times how well the foot named
/// there lies on the segment and is square to it.
float line_support(const MapView& lines, const LineSegment& segment);

}  // namespace pllit
