// Pictures of a session: the thermographic map from above, and what a camera showed of a finding.
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

#include "pllit/state/anomaly.hpp"
#include "pllit/state/table.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

/// Takes the 2nd to the 98th percentile of values to 0 to 255, what lies beyond to the ends.
class Stretch {
 public:
  explicit Stretch(std::vector<float> values);
  float operator()(float value) const;

 private:
  float low_ = 0.0F, scale_ = 0.0F;
};

struct PlanConfig {
  int width_px = 1000;
  double margin_m = 1.0;
  double least_cell_m = 0.05;  ///< side of a picture's pixel, at least
};

/// Seen from above, x to the right and y up, CV_8UC3: the field `intensity` of a map in pseudo-colour from its 2nd to
/// its 98th percentile (grey where a cloud has no such field), the way in white, alarms as numbered rings, a bar of one
/// or more metres. Empty for an empty map.
cv::Mat plan_of(const PointTable& map, const Trajectory& trajectory, std::span<const Anomaly> alarms,
                const PlanConfig& config = {});

/// Pseudo-colour and grey side by side, enlarged to be looked at, CV_8UC3. Takes CV_8UC1 and CV_16UC1.
cv::Mat thermogram(const cv::Mat& raw);

/// The bytes of a PNG file.
std::string png_of(const cv::Mat& picture);

}  // namespace pllit
