// Key points and their descriptors out of the network's maps.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "pllit/thermal/corners.hpp"
#include "pllit/thermal/network_maps.hpp"

namespace pllit {

struct PointDecoding {
  int most = 400;
  double least_score = 0.005;   ///< probability that a pixel is a key point
  int suppression_px = 4;       ///< a point is the best within a square of twice this and one
  double most_radius_px = 8.0;  ///< points keep at least so far apart where there are enough of them
  int margin_px = 4;            ///< nothing nearer to the image's border
};

/// Local maxima of the scores (CV_32FC1, one a pixel) to a fraction of a pixel, spread evenly, best first. Only the
/// `image` in the upper left of the map counts: the rest pads it.
std::vector<Corner> decode_points(const cv::Mat& scores, const cv::Size& image, const PointDecoding& config);

/// Descriptors at places in pixels, interpolated between cells of kDescriptorStride_px: CV_32FC1, a row of unit length
/// each.
cv::Mat sample_descriptors(const MapView& descriptors, const std::vector<Corner>& points);

}  // namespace pllit
