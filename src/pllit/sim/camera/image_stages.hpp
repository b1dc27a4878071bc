// Stages that an image passes between the optics and the counts.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "pllit/base/arena.hpp"

namespace pllit {

/// Gaussian blur of a CV_32FC1 image, separable, borders repeated; sigma_px <= 0 returns the image.
cv::Mat blurred(const cv::Mat& image, double sigma_px, Arena& arena);

/// Adds white noise to a CV_32FC1 image: row r draws from stream r of `seed`.
void add_noise(cv::Mat& image, float sigma, std::uint64_t seed, Arena& arena);

/// Share of light that reaches a place in the image: 1 in the middle, 1 - fall_off in the corners, quadratic between.
float vignetting(int column, int row, int width, int height, double fall_off);

}  // namespace pllit
