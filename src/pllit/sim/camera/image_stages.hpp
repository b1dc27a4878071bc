// Stages that an image passes between the optics and the counts.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "pllit/base/arena.hpp"
#include "pllit/sim/random.hpp"

namespace pllit {

/// Approximately normal, unit variance, within +-4.9: the sum of eight 16-bit uniform numbers (Irwin-Hall), six times
/// as fast as the exact transform.
inline float quick_gaussian(Random& random) {
  std::uint32_t sum = 0;
  for (int word = 0; word < 2; ++word) {
    const std::uint64_t bits = random.bits();
    for (int shift = 0; shift < 64; shift += 16) sum += static_cast<std::uint32_t>(bits >> shift) & 0xffffU;
  }
  constexpr float mean = 8.0F * 32767.5F, inverse_sigma = 1.0F / 53509.96F;  // sqrt(8 (2^32 - 1) / 12)
  return (static_cast<float>(sum) - mean) * inverse_sigma;
}

/// Gaussian blur of a CV_32FC1 image, separable, borders repeated; sigma_px <= 0 returns the image.
cv::Mat blurred(const cv::Mat& image, double sigma_px, Arena& arena);

/// Adds white noise to a CV_32FC1 image: row r draws from stream r of `seed`.
void add_noise(cv::Mat& image, float sigma, std::uint64_t seed, Arena& arena);

/// Share of light that reaches a place in the image: 1 in the middle, 1 - fall_off in the corners, quadratic between.
float vignetting(int column, int row, int width, int height, double fall_off);

}  // namespace pllit
