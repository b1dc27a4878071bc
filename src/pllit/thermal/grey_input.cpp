#include "pllit/thermal/grey_input.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace pllit {
namespace {

/// 0 to 255 for any grey: itself but for the outermost 24 at either end, which hold all that lies beyond.
double held(double grey) {
  constexpr double kEnd = 24.0;
  const auto squeezed = [](double beyond) { return kEnd * beyond / (kEnd + beyond); };
  if (grey < kEnd) return kEnd - squeezed(kEnd - grey);
  if (grey > 255.0 - kEnd) return 255.0 - kEnd + squeezed(grey - (255.0 - kEnd));
  return grey;
}

CountRange wanted_range(const cv::Mat& counts, const GreyInputConfig& config, CountRange& inner) {
  // Every fourth pixel of every fourth row tells the quantiles well enough.
  std::vector<std::uint16_t> sample;
  for (int row = 0; row < counts.rows; row += 4)
    for (int column = 0; column < counts.cols; column += 4) sample.push_back(counts.at<std::uint16_t>(row, column));
  const auto at = [&](double share) {
    const auto place = sample.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sample.size() - 1));
    std::ranges::nth_element(sample, place);
    return static_cast<double>(*place);
  };
  inner = {at(config.tail), at(1.0 - config.tail)};
  const double middle = 0.5 * (inner.low + inner.high);
  const double half = std::max(0.5 * (1.0 + 2.0 * config.margin) * (inner.high - inner.low), 0.5 * config.least_counts);
  return {middle - half, middle + half};
}

}  // namespace

cv::Mat one_channel(const cv::Mat& counts) {
  assert(counts.type() == CV_8UC1 || counts.type() == CV_8UC3 || counts.type() == CV_16UC1);
  if (counts.channels() == 1) return counts;
  cv::Mat grey;
  cv::cvtColor(counts, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

cv::Mat calibrated_image(const cv::Mat& grey, const GreyCurve& curve) {
  cv::Mat table(1, 256, CV_8UC1), image;
  for (int raw = 0; raw < 256; ++raw)
    table.at<std::uint8_t>(raw) = static_cast<std::uint8_t>(std::lround(held(curve(raw))));
  cv::LUT(grey, table, image);
  return image;
}

CountRange count_range(const cv::Mat& counts, const std::optional<CountRange>& last, const GreyInputConfig& config) {
  CountRange inner;
  const CountRange wanted = wanted_range(counts, config, inner);
  if (!last) return wanted;
  const double width = last->high - last->low;
  const bool holds = inner.low >= last->low && inner.high <= last->high,
             filled = wanted.high - wanted.low >= config.least_filled * width;
  if (holds && filled) return *last;
  const bool jumped = inner.low > last->high || inner.high < last->low;
  if (jumped) return wanted;
  return {std::lerp(last->low, wanted.low, config.speed), std::lerp(last->high, wanted.high, config.speed)};
}

cv::Mat mapped(const cv::Mat& counts, const CountRange& range) {
  const double scale = 255.0 / std::max(range.high - range.low, 1.0);
  cv::Mat image;
  counts.convertTo(image, CV_8U, scale, -range.low * scale);
  return image;
}

}  // namespace pllit
