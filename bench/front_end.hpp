// The image front end in the order in which a run goes through it, without a filter: for benchmarks.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "pllit/thermal/classical_extractor.hpp"
#include "pllit/thermal/grey_input.hpp"
#include "pllit/thermal/keyframe_window.hpp"
#include "pllit/thermal/matching.hpp"
#include "pllit/thermal/photometric_chain.hpp"

namespace pllit::bench {

/// What came of one image.
struct FrontEndImage {
  cv::Mat image;  ///< that features were sought in
  Features features;
  Tracks tracks;  ///< with the window before the image
  std::size_t keyframes = 0;
  PhotometricFit fit;
  GreyCurve curve;
};

class FrontEnd {
 public:
  struct Config {
    Camera camera;
    MatchConfig matching{};
    bool calibrate = true;
    std::function<void(Tracks&, const Features&)> disturb{};  ///< what is done to the tracks before greys are taken
  };
  explicit FrontEnd(Config config) : config_(std::move(config)), extractor_({}) {}

  /// raw: CV_8UC1. No point has a depth.
  FrontEndImage take(const cv::Mat& raw, Time time, const SE3& T_W_C) {
    FrontEndImage out;
    out.image = config_.calibrate ? calibrated_image(raw, chain_.curve) : raw;
    out.features = *extractor_.extract(out.image);
    out.tracks = match_to_keyframes(out.features, {}, T_W_C, window_, config_.camera, config_.matching, arena_);
    out.keyframes = window_.size();
    if (config_.disturb) config_.disturb(out.tracks, out.features);
    const cv::Mat around = greys_around(raw, out.features.points_px);
    if (config_.calibrate) {
      ChainStep step = advanced(chain_, raw, around, out.tracks, window_, {});
      chain_ = std::move(step.chain);
      out.fit = std::move(step.fit);
    }
    out.curve = chain_.curve;
    if (wants_keyframe(out.tracks, window_, out.features, time, raw.cols, {})) add_keyframe(out, around, time, T_W_C);
    return out;
  }

 private:
  void add_keyframe(const FrontEndImage& now, const cv::Mat& around, Time time, const SE3& T_W_C) {
    if (std::ssize(window_) == KeyframeConfig{}.most)
      window_.erase(window_.begin() + static_cast<std::ptrdiff_t>(expendable(now.tracks, window_)));
    Keyframe keyframe{.id = next_id_++,
                      .time = time,
                      .T_W_C = T_W_C,
                      .features = strongest(now.features, KeyframeConfig{}.most_points)};
    keyframe.depths.resize(keyframe.features.points_px.size());
    set_greys(keyframe, around, now.curve);
    window_.push_back(std::move(keyframe));
  }

  Config config_;
  ClassicalExtractor extractor_;
  Arena arena_{2};
  PhotometricChain chain_;
  std::vector<Keyframe> window_;
  std::uint32_t next_id_ = 0;
};

/// How many points of the tracks with the newest keyframe are anchored to a line.
inline int anchored(const FrontEndImage& now) {
  int count = 0;
  for (const PointMatch& match : now.tracks.points)
    count += match.line_px >= 0.0 && match.keyframe + 1 == now.keyframes;
  return count;
}

}  // namespace pllit::bench
