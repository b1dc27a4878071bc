#include "pllit/thermal/image_check.hpp"

#include <cstdint>
#include <format>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace pllit {
namespace {

using Kind = ImageVerdict::Kind;

/// Counts of how often each value occurs.
class Histogram {
 public:
  explicit Histogram(const cv::Mat& image) : values_(image.depth() == CV_8U ? 256 : 65536, 0), pixels_(image.total()) {
    for (int row = 0; row < image.rows; ++row)
      for (int column = 0; column < image.cols; ++column)
        ++values_[image.depth() == CV_8U ? image.at<std::uint8_t>(row, column) : image.at<std::uint16_t>(row, column)];
  }
  double quantile(double share) const {
    const double rank = share * static_cast<double>(pixels_);
    double sum = 0.0;
    for (std::size_t value = 0; value < values_.size(); ++value)
      if ((sum += values_[value]) > rank) return static_cast<double>(value);
    return static_cast<double>(values_.size() - 1);
  }
  double clipped_share() const {
    return static_cast<double>(values_.front() + values_.back()) / static_cast<double>(pixels_);
  }

 private:
  std::vector<std::uint32_t> values_;
  std::size_t pixels_;
};

double changed_share(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a.reshape(1), b.reshape(1), difference);
  return static_cast<double>(cv::countNonZero(difference)) / static_cast<double>(difference.total());
}

ImageVerdict verdict_on(const cv::Mat& image, const ImageCheckConfig& config) {
  const Histogram histogram(image);
  const bool counts = image.depth() == CV_16U;
  const double spread = histogram.quantile(0.95) - histogram.quantile(0.05), median = histogram.quantile(0.5);
  if (const double share = histogram.clipped_share(); share > config.clipped_share)
    return {.kind = Kind::saturated,
            .reason = std::format("saturated: {:.0f} % of the pixels lie at an end of the range", 100.0 * share)};
  if (!counts && median < config.dark_grey)
    return {.kind = Kind::dark,
            .reason = std::format("too dark: half of the pixels are below grey {:.0f}", median + 1)};
  if (!counts && median > config.bright_grey)
    return {.kind = Kind::bright,
            .reason = std::format("too bright: half of the pixels are above grey {:.0f}", median - 1)};
  if (spread < (counts ? config.least_spread_counts : config.least_spread_grey))
    return {
        .kind = Kind::blank,
        .reason = std::format("blank: 90 % of the pixels lie within {:.0f} {}", spread, counts ? "counts" : "greys")};
  return {};
}

}  // namespace

ImageVerdict judge(const CameraFrame& frame, const ImageHistory& before, const ImageCheckConfig& config) {
  const cv::Mat& image = frame.counts;
  if (image.empty() || (image.type() != CV_8UC1 && image.type() != CV_8UC3 && image.type() != CV_16UC1))
    return {.kind = Kind::unknown_format,
            .reason = std::format("neither 8-bit grey, nor BGR, nor 16-bit counts: {} x {} pixels of OpenCV's type {}",
                                  image.cols, image.rows, image.type())};
  if (before.counts.type() == image.type() && before.counts.size() == image.size())
    if (const double share = changed_share(image, before.counts); share < config.changed_share)
      return {.kind = Kind::repeated,
              .reason = std::format("repeats the image before: {:.2f} % of its values differ", 100.0 * share)};
  ImageVerdict verdict = verdict_on(image.reshape(1), config);
  verdict.after_shutter = before.repetitions >= config.shutter_images ||
                          (before.repetitions > 0 && frame.time - before.time >= config.shutter_time);
  return verdict;
}

Expected<void> fits(const cv::Mat& counts, const Camera& camera) {
  if (counts.cols == camera.width && counts.rows == camera.height) return {};
  return input_error(std::format("images are {} x {} px, but the calibration (rig.camera.size_px) is for {} x {}",
                                 counts.cols, counts.rows, camera.width, camera.height));
}

ImageHistory remembered(const CameraFrame& frame, const ImageVerdict& verdict, const ImageHistory& before) {
  if (verdict.kind == Kind::unknown_format) return before;
  if (verdict.kind == Kind::repeated)
    return {.counts = before.counts, .time = before.time, .repetitions = before.repetitions + 1};
  return {.counts = frame.counts, .time = frame.time, .repetitions = 0};
}

}  // namespace pllit
