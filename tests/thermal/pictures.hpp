// Pictures for tests: blurred blocks on a ramp, as a thermal camera might see a wall of cabinets.
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

namespace pllit::test {

struct Picture {
  int width = 320, height = 256;
  int blocks = 40;
  double noise_grey = 1.0;
};

/// CV_32FC1, greys 30 to 220, without noise.
inline cv::Mat scene(const Picture& picture, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_int_distribution<int> x(0, picture.width - 1), y(0, picture.height - 1), size(14, 70), grey(30, 220);
  cv::Mat image(picture.height, picture.width, CV_32FC1);
  for (int row = 0; row < image.rows; ++row) image.row(row) = 90.0 + 40.0 * row / image.rows;
  for (int i = 0; i < picture.blocks; ++i) {
    const cv::Rect block(x(engine), y(engine), size(engine), size(engine));
    cv::rectangle(image, block, cv::Scalar(grey(engine)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, {}, 1.0);
  return image;
}

/// The greys with white noise, rounded; CV_8UC1.
inline cv::Mat seen(const cv::Mat& greys, double noise_grey, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<float> noise(0.0F, static_cast<float>(std::max(noise_grey, 1e-6)));
  cv::Mat image(greys.size(), CV_8UC1);
  for (int row = 0; row < greys.rows; ++row)
    for (int column = 0; column < greys.cols; ++column)
      image.at<std::uint8_t>(row, column) =
          cv::saturate_cast<std::uint8_t>(greys.at<float>(row, column) + noise(engine));
  return image;
}

inline cv::Mat picture(const Picture& picture, unsigned seed) {
  return seen(scene(picture, seed), picture.noise_grey, seed + 1000);
}

}  // namespace pllit::test
