// Points and lines by the network in models/, run by ONNX Runtime.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pllit/thermal/decode_lines.hpp"
#include "pllit/thermal/decode_points.hpp"
#include "pllit/thermal/features.hpp"

namespace pllit {

struct NetworkConfig {
  /// Where points lie: at the network's own key points, or at Shi-Tomasi corners of the contrast-normalised image
  /// (corners.hpp).
  enum class Points { network, corners };

  std::filesystem::path model;
  std::string provider = "cpu";           ///< "cpu", "cuda" or "tensorrt", where the installed ONNX Runtime has it
  int threads = 2;                        ///< that one image is shared among; belongs to this extractor alone
  Points place_points = Points::network;  ///< descriptors and lines are the network's either way
  PointDecoding points = {};
  CornerConfig corners = {};  ///< with Points::corners; how many and how even is said in `points`
  LineDecoding lines = {};
};

/// Pads images at their right and lower borders to the multiple of 16 pixels that the network needs, so any size will
/// do.
class NetworkExtractor : public FeatureExtractor {
 public:
  /// Input error: no such model, not an ONNX model, inputs or outputs other than models/README.md states, an execution
  /// provider that is unknown or not installed (the message lists those that are).
  static Expected<std::unique_ptr<NetworkExtractor>> open(const NetworkConfig& config);
  ~NetworkExtractor() override;

  /// Input error: not CV_8UC1, or fewer than 16 x 16 pixels. Failure: ONNX Runtime's own. A blank image has no
  /// features.
  Expected<Features> extract(const cv::Mat& grey) override;
  std::string_view name() const override { return name_; }

 private:
  struct Session;
  NetworkExtractor(NetworkConfig config, std::unique_ptr<Session> session);
  NetworkConfig config_;
  std::unique_ptr<Session> session_;
  std::string name_;
};

/// Execution providers that the installed ONNX Runtime has, by the names that NetworkConfig takes.
std::vector<std::string> installed_providers();

/// Turns segments so that their brighter side lies to the left of the way from start to end as seen on the screen,
/// where the difference is larger than rounding (the convention of LSD).
void turn_brighter_side_left(const cv::Mat& grey, std::vector<LineSegment>& lines);

}  // namespace pllit
