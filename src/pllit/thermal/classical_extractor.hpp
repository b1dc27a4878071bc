// Points and lines without a network: the baseline, and what runs where a network's file is missing.
#pragma once

#include "pllit/thermal/corners.hpp"
#include "pllit/thermal/features.hpp"
#include "pllit/thermal/line_segments.hpp"

namespace pllit {

struct ClassicalConfig {
  int most_points = 1000;
  double most_radius_px = 10.0;  ///< points keep at least so far apart where there are enough of them
  CornerConfig corners{};
  LineConfig lines{};
};

/// Shi-Tomasi corners of the contrast-normalised image, spread evenly, described by the directions of the gradients
/// around them; lines by LSD.
class ClassicalExtractor : public FeatureExtractor {
 public:
  explicit ClassicalExtractor(const ClassicalConfig& config = {}) : config_(config) {}
  /// Input error: not CV_8UC1, or fewer than 16 x 16 pixels.
  Expected<Features> extract(const cv::Mat& grey) override;
  std::string_view name() const override { return "classical"; }

 private:
  ClassicalConfig config_;
};

}  // namespace pllit
