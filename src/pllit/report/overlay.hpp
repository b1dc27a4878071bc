// LiDAR points drawn over images.
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

#include "pllit/geometry/camera.hpp"

namespace pllit {

struct OverlayImage {
  cv::Mat counts;  ///< CV_8UC1, CV_8UC3 or CV_16UC1, as large as the camera's images
  std::vector<Eigen::Vector3f> points_C;
  std::string caption;
};

/// The images in two columns, CV_8UC3, grey, each stretched by itself; each point that the camera sees as a dot, from
/// red (near) through green to blue (far) by the logarithm of its range, with the same colours in all of them. Edges in
/// the image and steps of colour meet where extrinsics, intrinsics and clocks are right. Empty without images.
cv::Mat overlay_sheet(std::span<const OverlayImage> images, const Camera& camera);

}  // namespace pllit
