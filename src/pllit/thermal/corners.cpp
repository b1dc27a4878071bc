#include "pllit/thermal/corners.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

namespace pllit {
namespace {

/// Where the parabola through three values has its top, from the middle one, within half a pixel.
float top_of_parabola(float left, float middle, float right) {
  const float bend = left - 2.0F * middle + right;
  return bend < 0.0F ? std::clamp(0.5F * (left - right) / bend, -0.5F, 0.5F) : 0.0F;
}

/// Corners that were taken, by squares of the plane as wide as their least distance.
class Taken {
 public:
  Taken(float width, float height, float radius)
      : radius_(radius),
        columns_(static_cast<int>(width / radius) + 1),
        rows_(static_cast<int>(height / radius) + 1),
        squares_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

  bool has_near(const Eigen::Vector2f& at) const {
    const int column = static_cast<int>(at.x() / radius_), row = static_cast<int>(at.y() / radius_);
    for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows_ - 1); ++r)
      for (int c = std::max(column - 1, 0); c <= std::min(column + 1, columns_ - 1); ++c)
        for (const Eigen::Vector2f& other : square(c, r))
          if ((other - at).squaredNorm() < radius_ * radius_) return true;
    return false;
  }
  void add(const Eigen::Vector2f& at) {
    square(static_cast<int>(at.x() / radius_), static_cast<int>(at.y() / radius_)).push_back(at);
  }

 private:
  std::vector<Eigen::Vector2f>& square(int column, int row) {
    return squares_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(column)];
  }
  const std::vector<Eigen::Vector2f>& square(int column, int row) const {
    return squares_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(column)];
  }

  float radius_;
  int columns_, rows_;
  std::vector<std::vector<Eigen::Vector2f>> squares_;
};

/// The best first, each unless a better one is near; at most `most`.
std::vector<Corner> thinned(const std::vector<Corner>& corners, float radius, std::size_t most) {
  float width = 0.0F, height = 0.0F;
  for (const Corner& corner : corners) {
    width = std::max(width, corner.at_px.x());
    height = std::max(height, corner.at_px.y());
  }
  Taken taken(width, height, radius);
  std::vector<Corner> kept;
  for (const Corner& corner : corners) {
    if (kept.size() == most) break;
    if (taken.has_near(corner.at_px)) continue;
    taken.add(corner.at_px);
    kept.push_back(corner);
  }
  return kept;
}

cv::Mat contrast_normalised(const cv::Mat& grey, const CornerConfig& config) {
  cv::Mat image, mean, squares;
  grey.convertTo(image, CV_32F);
  cv::GaussianBlur(image, image, {}, config.blur_px);
  const auto floor = static_cast<float>(config.noise_floors * noise_grey(grey));
  const cv::Size window(config.contrast_window_px, config.contrast_window_px);
  cv::boxFilter(image, mean, CV_32F, window, {-1, -1}, true, cv::BORDER_REFLECT);
  cv::sqrBoxFilter(image, squares, CV_32F, window, {-1, -1}, true, cv::BORDER_REFLECT);
  for (int row = 0; row < image.rows; ++row) {
    Eigen::Map<Eigen::ArrayXf> value(image.ptr<float>(row), image.cols);
    const Eigen::Map<const Eigen::ArrayXf> m(mean.ptr<float>(row), image.cols), s(squares.ptr<float>(row), image.cols);
    value = (value - m) / ((s - m * m).max(0.0F).sqrt() + floor);
  }
  return image;
}

}  // namespace

double noise_grey(const cv::Mat& grey) {
  std::vector<int> responses;
  for (int row = 1; row + 1 < grey.rows; row += 3) {
    const auto *above = grey.ptr<std::uint8_t>(row - 1), *here = grey.ptr<std::uint8_t>(row),
               *below = grey.ptr<std::uint8_t>(row + 1);
    for (int column = 1; column + 1 < grey.cols; column += 3) {
      const auto across = [column](const std::uint8_t* p) { return p[column - 1] - 2 * p[column] + p[column + 1]; };
      responses.push_back(std::abs(across(above) - 2 * across(here) + across(below)));
    }
  }
  if (responses.empty()) return 0.3;
  const auto middle = responses.begin() + static_cast<std::ptrdiff_t>(responses.size() / 2);
  std::ranges::nth_element(responses, middle);
  constexpr double kMedian = 0.6745, kMask = 6.0, kRounding = 0.29;
  return std::max(*middle / (kMedian * kMask), kRounding);
}

std::vector<Corner> corners_of(const cv::Mat& grey, const CornerConfig& config) {
  cv::Mat strength, best;
  cv::cornerMinEigenVal(contrast_normalised(grey, config), strength, config.window_px);
  cv::dilate(strength, best, cv::getStructuringElement(cv::MORPH_RECT, {5, 5}));
  const int margin = std::max(config.margin_px, 1);
  std::vector<Corner> corners;
  for (int row = margin; row < strength.rows - margin; ++row) {
    const auto *here = strength.ptr<float>(row), *above = strength.ptr<float>(row - 1),
               *below = strength.ptr<float>(row + 1), *most = best.ptr<float>(row);
    for (int column = margin; column < strength.cols - margin; ++column) {
      if (here[column] < most[column] || here[column] < static_cast<float>(config.least_strength)) continue;
      const float dx = top_of_parabola(here[column - 1], here[column], here[column + 1]);
      const float dy = top_of_parabola(above[column], here[column], below[column]);
      corners.push_back({{static_cast<float>(column) + dx, static_cast<float>(row) + dy}, here[column]});
    }
  }
  std::ranges::stable_sort(corners, std::ranges::greater{}, &Corner::strength);
  return corners;
}

std::vector<Corner> spread_evenly(const std::vector<Corner>& corners, int most, float most_radius_px) {
  if (most <= 0) return {};
  const auto count = static_cast<std::size_t>(most);
  float enough = 1.0F, too_few = most_radius_px;
  std::vector<Corner> kept = thinned(corners, most_radius_px, count);
  if (kept.size() == count) return kept;
  kept = thinned(corners, enough, count);
  if (kept.size() < count) return kept;
  constexpr float kClose_px = 0.5F;
  while (too_few - enough > kClose_px) {
    const float radius = 0.5F * (enough + too_few);
    std::vector<Corner> some = thinned(corners, radius, count);
    if (some.size() < count) {
      too_few = radius;
    } else {
      enough = radius;
      kept = std::move(some);
    }
  }
  return kept;
}

}  // namespace pllit
