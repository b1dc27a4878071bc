#include "pllit/sim/camera/image_stages.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

constexpr std::size_t kRows = 16;

/// Right half of the kernel, the middle first, with sum 1 over both halves.
std::vector<float> half_kernel(double sigma_px) {
  const int reach = static_cast<int>(std::ceil(3.0 * sigma_px));
  std::vector<double> weight;
  double sum = 0.0;
  for (int i = 0; i <= reach; ++i) {
    weight.push_back(std::exp(-0.5 * i * i / (sigma_px * sigma_px)));
    sum += i == 0 ? weight.back() : 2.0 * weight.back();
  }
  std::vector<float> kernel;
  for (const double w : weight) kernel.push_back(static_cast<float>(w / sum));
  return kernel;
}

void blur_row(const float* in, float* out, int width, const std::vector<float>& kernel) {
  const int reach = static_cast<int>(kernel.size()) - 1;
  for (int column = 0; column < width; ++column) {
    float sum = kernel[0] * in[column];
    for (int i = 1; i <= reach; ++i)
      sum += kernel[static_cast<std::size_t>(i)] * (in[std::max(column - i, 0)] + in[std::min(column + i, width - 1)]);
    out[column] = sum;
  }
}

void blur_columns(const cv::Mat& in, int row, float* out, const std::vector<float>& kernel) {
  const float* middle = in.ptr<float>(row);
  for (int column = 0; column < in.cols; ++column) out[column] = kernel[0] * middle[column];
  for (int i = 1; i < static_cast<int>(kernel.size()); ++i) {
    const float *above = in.ptr<float>(std::max(row - i, 0)), *below = in.ptr<float>(std::min(row + i, in.rows - 1));
    const float weight = kernel[static_cast<std::size_t>(i)];
    for (int column = 0; column < in.cols; ++column) out[column] += weight * (above[column] + below[column]);
  }
}

}  // namespace

cv::Mat blurred(const cv::Mat& image, double sigma_px, Arena& arena) {
  if (sigma_px <= 0.0) return image;
  const std::vector<float> kernel = half_kernel(sigma_px);
  const auto rows = static_cast<std::size_t>(image.rows);
  cv::Mat across(image.size(), CV_32FC1), both(image.size(), CV_32FC1);
  arena.for_chunks(rows, kRows, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
      blur_row(image.ptr<float>(row), across.ptr<float>(row), image.cols, kernel);
  });
  arena.for_chunks(rows, kRows, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
      blur_columns(across, row, both.ptr<float>(row), kernel);
  });
  return both;
}

void add_noise(cv::Mat& image, float sigma, std::uint64_t seed, Arena& arena) {
  arena.for_chunks(static_cast<std::size_t>(image.rows), kRows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      Random random(seed, row);
      float* value = image.ptr<float>(static_cast<int>(row));
      for (int column = 0; column < image.cols; ++column) value[column] += sigma * quick_gaussian(random);
    }
  });
}

float vignetting(int column, int row, int width, int height, double fall_off) {
  const double x = (2.0 * column + 1.0) / width - 1.0, y = (2.0 * row + 1.0) / height - 1.0;
  return static_cast<float>(1.0 - fall_off * 0.5 * (x * x + y * y));
}

}  // namespace pllit
