#include "pllit/thermal/patch_descriptor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace pllit {
namespace {

constexpr int kDirections = 8;
using Histogram = Eigen::Matrix<float, kDirections, 1>;

/// Directions of gradients in an image of half the size, each pixel's strength shared between the two nearest of eight.
cv::Mat directions_of(const cv::Mat& half) {
  cv::Mat dx, dy, length, angle;
  cv::Sobel(half, dx, CV_32F, 1, 0, 1);
  cv::Sobel(half, dy, CV_32F, 0, 1, 1);
  cv::cartToPolar(dx, dy, length, angle);
  cv::sqrt(length, length);
  cv::Mat directions = cv::Mat::zeros(half.size(), CV_32FC(kDirections));
  constexpr float kPerRadian = kDirections / (2.0F * std::numbers::pi_v<float>);
  for (int row = 0; row < half.rows; ++row) {
    const auto *l = length.ptr<float>(row), *a = angle.ptr<float>(row);
    auto* out = directions.ptr<float>(row);
    for (int column = 0; column < half.cols; ++column, out += kDirections) {
      const float place = a[column] * kPerRadian, below = std::floor(place), share = place - below;
      const int bin = static_cast<int>(below) % kDirections;
      out[bin] += (1.0F - share) * l[column];
      out[(bin + 1) % kDirections] += share * l[column];
    }
  }
  return directions;
}

/// Bilinear; outside the nearest pixel counts.
Histogram sample(const cv::Mat& directions, float x, float y) {
  x = std::clamp(x, 0.0F, static_cast<float>(directions.cols - 1));
  y = std::clamp(y, 0.0F, static_cast<float>(directions.rows - 1));
  const int left = std::min(static_cast<int>(x), directions.cols - 2),
            top = std::min(static_cast<int>(y), directions.rows - 2);
  const float u = x - static_cast<float>(left), v = y - static_cast<float>(top);
  const auto at = [&](int row) {
    const float* p = directions.ptr<float>(row) + static_cast<std::ptrdiff_t>(left) * kDirections;
    return Histogram((1.0F - u) * Eigen::Map<const Histogram>(p) + u * Eigen::Map<const Histogram>(p + kDirections));
  };
  return (1.0F - v) * at(top) + v * at(top + 1);
}

struct Place {
  float x, y;  // px of the half image, from the point
  bool wide;   // over a wider area
};

std::array<Place, 15> layout() {
  std::array<Place, 15> places{};
  const auto ring = [&](std::size_t first, int count, float radius, bool wide) {
    for (int i = 0; i < count; ++i) {
      const float angle = 2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(count);
      places[first + static_cast<std::size_t>(i)] = {radius * std::cos(angle), radius * std::sin(angle), wide};
    }
  };
  ring(0, 1, 0.0F, false);
  ring(1, 6, 3.5F, false);
  ring(7, 8, 8.0F, true);
  return places;
}

}  // namespace

cv::Mat describe_patches(const cv::Mat& grey, std::span<const Eigen::Vector2f> points_px) {
  cv::Mat half, narrow, wide;
  cv::GaussianBlur(grey, half, {}, 1.2);
  cv::resize(half, half, {(grey.cols + 1) / 2, (grey.rows + 1) / 2}, 0.0, 0.0, cv::INTER_AREA);
  half.convertTo(half, CV_32F);
  cv::GaussianBlur(directions_of(half), narrow, {7, 7}, 1.3, 1.3, cv::BORDER_REPLICATE);
  cv::GaussianBlur(narrow, wide, {9, 9}, 2.2, 2.2, cv::BORDER_REPLICATE);
  const float across = static_cast<float>(half.cols) / static_cast<float>(grey.cols),
              down = static_cast<float>(half.rows) / static_cast<float>(grey.rows);
  const std::array<Place, 15> places = layout();
  cv::Mat rows(static_cast<int>(points_px.size()), kDescriptorLength, CV_32FC1);
  for (int i = 0; i < rows.rows; ++i) {
    const Eigen::Vector2f& point = points_px[static_cast<std::size_t>(i)];
    const float x = (point.x() + 0.5F) * across - 0.5F, y = (point.y() + 0.5F) * down - 0.5F;
    Eigen::Map<Eigen::Matrix<float, kDirections, 15>> histograms(rows.ptr<float>(i));
    for (std::size_t k = 0; k < places.size(); ++k)
      histograms.col(static_cast<Eigen::Index>(k)) =
          sample(places[k].wide ? wide : narrow, x + places[k].x, y + places[k].y);
    const float floor = 0.3F * histograms.colwise().norm().mean() + 1e-3F;
    for (Eigen::Index k = 0; k < histograms.cols(); ++k) histograms.col(k) /= histograms.col(k).norm() + floor;
    // What all points have in common (some gradient in each direction) is taken out: it tells nothing.
    for (Eigen::Index k = 0; k < histograms.cols(); ++k) histograms.col(k).array() -= histograms.col(k).mean();
    const float length = histograms.norm();
    if (length > 0.0F)
      histograms /= length;
    else
      histograms.setConstant(1.0F / std::sqrt(static_cast<float>(kDescriptorLength)));
  }
  return rows;
}

}  // namespace pllit
