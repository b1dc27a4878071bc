#include "pllit/sim/camera/agc.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace pllit {
namespace {

std::vector<std::uint32_t> histogram_of(const cv::Mat& counts, int levels) {
  std::vector<std::uint32_t> histogram(static_cast<std::size_t>(levels), 0);
  for (int row = 0; row < counts.rows; ++row) {
    const auto* value = counts.ptr<std::uint16_t>(row);
    for (int column = 0; column < counts.cols; ++column) ++histogram[value[column]];
  }
  return histogram;
}

/// The lowest count with more than `rank` pixels at or below it.
std::size_t count_at(const std::vector<std::uint32_t>& histogram, double rank) {
  double sum = 0.0;
  for (std::size_t count = 0; count < histogram.size(); ++count)
    if ((sum += histogram[count]) > rank) return count;
  return histogram.size() - 1;
}

GreyMapping linear(const std::vector<std::uint32_t>& histogram, double pixels, const AgcConfig& config) {
  const auto low = static_cast<double>(count_at(histogram, config.tail * pixels));
  const auto high = static_cast<double>(count_at(histogram, (1.0 - config.tail) * pixels));
  const double gain = std::min(255.0 / std::max(high - low, 1.0), config.max_gain);
  const double middle = gain * (high - low) >= 255.0 ? 127.5 : config.middle_grey;
  GreyMapping mapping(histogram.size());
  for (std::size_t count = 0; count < mapping.size(); ++count)
    mapping[count] =
        static_cast<float>(std::clamp(middle + gain * (static_cast<double>(count) - 0.5 * (low + high)), 0.0, 255.0));
  return mapping;
}

GreyMapping plateau(const std::vector<std::uint32_t>& histogram, double pixels, const AgcConfig& config) {
  const double limit = config.plateau * pixels;
  double clipped_sum = 0.0;
  for (const std::uint32_t count : histogram) clipped_sum += std::min<double>(count, limit);
  GreyMapping mapping(histogram.size());
  double grey = 0.0;
  for (std::size_t count = 0; count < mapping.size(); ++count) {
    grey += std::min(255.0 * std::min<double>(histogram[count], limit) / clipped_sum, config.max_gain);
    mapping[count] = static_cast<float>(grey);
  }
  const double lowest = std::clamp(config.middle_grey - 0.5 * grey, 0.0, 255.0 - std::min(grey, 255.0));
  for (float& value : mapping) value = std::min(value + static_cast<float>(lowest), 255.0F);
  return mapping;
}

}  // namespace

GreyMapping grey_mapping(const cv::Mat& counts, const AgcConfig& config, int levels) {
  const std::vector<std::uint32_t> histogram = histogram_of(counts, levels);
  const auto pixels = static_cast<double>(counts.total());
  return config.kind == AgcConfig::Kind::linear ? linear(histogram, pixels, config)
                                                : plateau(histogram, pixels, config);
}

GreyMapping smoothed(const GreyMapping& before, GreyMapping now, int speed_256) {
  const float share = static_cast<float>(speed_256) / 256.0F;
  for (std::size_t count = 0; count < before.size(); ++count) now[count] = std::lerp(before[count], now[count], share);
  return now;
}

cv::Mat applied(const GreyMapping& mapping, const cv::Mat& counts) {
  std::vector<std::uint8_t> grey(mapping.size());
  std::ranges::transform(mapping, grey.begin(),
                         [](float value) { return static_cast<std::uint8_t>(std::lround(value)); });
  cv::Mat image(counts.size(), CV_8UC1);
  for (int row = 0; row < counts.rows; ++row) {
    const auto* value = counts.ptr<std::uint16_t>(row);
    auto* out = image.ptr<std::uint8_t>(row);
    for (int column = 0; column < counts.cols; ++column) out[column] = grey[value[column]];
  }
  return image;
}

}  // namespace pllit
