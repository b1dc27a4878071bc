#include "pllit/thermal/classical_extractor.hpp"

#include <format>
#include <future>

#include "pllit/thermal/patch_descriptor.hpp"

namespace pllit {

Expected<Features> ClassicalExtractor::extract(const cv::Mat& grey) {
  constexpr int kLeast_px = 16;
  if (grey.type() != CV_8UC1 || grey.rows < kLeast_px || grey.cols < kLeast_px)
    return input_error(
        std::format("features need an 8-bit image of one channel and at least {0} x {0} pixels; this one has {1} x {2} "
                    "of OpenCV's type {3}",
                    kLeast_px, grey.cols, grey.rows, grey.type()));
  // Lines take about as long as points.
  auto lines = std::async(std::launch::async, [&] { return line_segments(grey, config_.lines); });
  std::vector<Corner> corners = corners_of(grey, config_.corners);
  if (std::ssize(corners) < config_.most_points / 3) {  // dim or bare: faint corners are better than none
    CornerConfig faint = config_.corners;
    faint.noise_floors *= 0.5;
    corners = corners_of(grey, faint);
  }
  corners = spread_evenly(corners, config_.most_points, static_cast<float>(config_.most_radius_px));
  Features features;
  for (const Corner& corner : corners) {
    features.points_px.push_back(corner.at_px);
    features.scores.push_back(corner.strength);
  }
  features.descriptors = describe_patches(grey, features.points_px);
  features.lines = lines.get();
  return features;
}

}  // namespace pllit
