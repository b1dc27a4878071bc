// Corners of images whose contrast differs from place to place and from frame to frame.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace pllit {

struct Corner {
  Eigen::Vector2f at_px = Eigen::Vector2f::Zero();
  float strength = 0.0F;
};

struct CornerConfig {
  double blur_px = 2.0;           ///< sigma, against noise; edges of thermal images are as wide
  int contrast_window_px = 129;   ///< side of the square whose contrast is divided out
  double noise_floors = 4.0;      ///< contrast of so many times the image's noise counts as none
  int window_px = 5;              ///< side of the square over which gradients are summed
  double least_strength = 0.003;  ///< squared normalised contrast a pixel
  int margin_px = 6;              ///< nothing nearer to the image's border
};

/// Standard deviation of an image's white noise, grey levels, by the median response to a mask that leaves out planes
/// (Immerkaer 1996); at least what rounding makes. grey: CV_8UC1.
double noise_grey(const cv::Mat& grey);

/// Local maxima of the smaller eigenvalue of the gradients' second moments (Shi and Tomasi 1994), to a fraction of a
/// pixel, in the normalised image: blurred, less the mean around, over the standard deviation around plus the noise
/// floor. What an affine change of the greys does to that is small where the contrast is well above the floor. Best
/// first. grey: CV_8UC1.
std::vector<Corner> corners_of(const cv::Mat& grey, const CornerConfig& config);

/// At most `most` of the corners, best first, no two nearer than a radius: the largest radius up to `most_radius_px`
/// that leaves enough of them (in the manner of Bailo et al. 2018). `corners` are sorted best first.
std::vector<Corner> spread_evenly(const std::vector<Corner>& corners, int most, float most_radius_px);

}  // namespace pllit
