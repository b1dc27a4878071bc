// What the surroundings of a point look like, in numbers that survive gain control.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <span>

namespace pllit {

/// One row of unit length for each point, CV_32FC1 with kDescriptorLength columns; grey: CV_8UC1.
///
/// Histograms of the directions of gradients, eight to a circle, at the point and on two rings around it, the outer
/// ones over wider areas (the layout is DAISY's: Tola, Lepetit and Fua 2010). Upright: the rig's own attitude is known
/// well enough. An increasing curve over the greys changes lengths of gradients, not their directions; lengths are
/// therefore compressed and each histogram is scaled on its own. Reaches about 26 px; beyond the image its border is
/// repeated.
cv::Mat describe_patches(const cv::Mat& grey, std::span<const Eigen::Vector2f> points_px);

inline constexpr int kDescriptorLength = 15 * 8;

}  // namespace pllit
