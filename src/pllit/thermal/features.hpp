// Points and lines of one image, and what finds them.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string_view>
#include <vector>

#include "pllit/base/error.hpp"

namespace pllit {

/// A straight edge in an image, in pixels; (0, 0) is the centre of the top left pixel.
struct LineSegment {
  Eigen::Vector2f start_px = Eigen::Vector2f::Zero(), end_px = Eigen::Vector2f::Zero();
  float score = 0.0F;  ///< 0 to 1

  float length_px() const { return (end_px - start_px).norm(); }
};

/// The first three have one entry a point.
struct Features {
  std::vector<Eigen::Vector2f> points_px;
  std::vector<float> scores;  ///< the higher the better; comparable within one extractor only
  cv::Mat descriptors;        ///< CV_32FC1, one row of unit length a point
  std::vector<LineSegment> lines;
};

/// Finds features in one image at a time; not for two threads at once.
class FeatureExtractor {
 public:
  virtual ~FeatureExtractor() = default;
  /// grey: CV_8UC1 of any size that holds a few pixels. Points come best first.
  virtual Expected<Features> extract(const cv::Mat& grey) = 0;
  /// In words, for reports: "network pl_net.onnx on cpu", "classical".
  virtual std::string_view name() const = 0;
};

}  // namespace pllit
