// From what a camera delivers to the 8-bit greys that features are sought in.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "pllit/thermal/photometric.hpp"

namespace pllit {

/// Counts that greys 0 and 255 stand for.
struct CountRange {
  double low = 0.0, high = 0.0;
};

struct GreyInputConfig {
  double tail = 0.005;        ///< share of the pixels at either end that the range need not hold
  double margin = 0.15;       ///< of an image's own spread, added at either end
  double least_counts = 100;  ///< width of the narrowest range: noise is not stretched over all greys
  double least_filled = 0.4;  ///< a range that the images fill less is too wide
  double speed = 0.05;        ///< share of the way to the range wanted, an image, while the last one does not do
};

/// One channel: 8-bit greys and 16-bit counts as they are, BGR by luminance. counts: CV_8UC1, CV_8UC3 or CV_16UC1.
cv::Mat one_channel(const cv::Mat& counts);

/// The calibrated image of a CV_8UC1 one, CV_8UC1. Calibrated greys can leave 0 to 255; so that order and some contrast
/// survive there, the outermost 24 greys at either end hold all greys beyond.
cv::Mat calibrated_image(const cv::Mat& grey, const GreyCurve& curve);

/// The range to map an image's CV_16UC1 counts with: the last image's as long as it holds this one and is filled by it,
/// so that greys are steady; else somewhat nearer to what this image wants, or just that for the first image and after
/// a jump beyond the range.
CountRange count_range(const cv::Mat& counts, const std::optional<CountRange>& last, const GreyInputConfig& config);

/// CV_8UC1, linear over the range.
cv::Mat mapped(const cv::Mat& counts, const CountRange& range);

}  // namespace pllit
