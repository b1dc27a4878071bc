// The pattern that an uncooled array lays over its images, and the shutter that takes it away.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "pllit/base/arena.hpp"
#include "pllit/base/time.hpp"
#include "pllit/sim/random.hpp"

namespace pllit {

/// Offsets walk as Brownian motion from what the last shutter event left; in K, sigmas.
struct FixedPatternModel {
  double column_walk = 0.006, pixel_walk = 0.005,
         whole_walk = 0.02;  ///< K/sqrt(s), of each column, pixel and the whole image
  double column_left = 0.008, pixel_left = 0.015, whole_left = 0.15;  ///< K, drawn anew at each event
};

inline constexpr FixedPatternModel kNoFixedPattern{
    .column_walk = 0.0, .pixel_walk = 0.0, .whole_walk = 0.0, .column_left = 0.0, .pixel_left = 0.0, .whole_left = 0.0};

/// Offsets of the pixels, in K.
class FixedPattern {
 public:
  FixedPattern(int width, int height, const FixedPatternModel& model, std::uint64_t seed);

  /// What is left after a shutter event.
  void reset(Arena& arena);
  void walk(double seconds, Arena& arena);
  /// Adds the pattern times `scale` to a CV_32FC1 image.
  void add_to(cv::Mat& image, float scale, Arena& arena) const;

 private:
  void disturb(double keep, double column_sigma, double pixel_sigma, double whole_sigma, Arena& arena);

  FixedPatternModel model_;
  Random random_;
  cv::Mat pixels_, columns_;  ///< CV_32FC1; one row
  float whole_ = 0.0F;
};

/// When a camera closes its shutter: events at random intervals, each of which freezes the video.
struct ShutterModel {
  double least_interval_s = 60.0, most_interval_s = 180.0;
  double least_freeze_s = 0.3, most_freeze_s = 0.5;
};

class Shutter {
 public:
  Shutter(const ShutterModel& model, Time start, std::uint64_t seed);

  /// To be asked with ascending times. closed: the video is frozen. events: how many have ended or passed so far.
  struct State {
    bool closed = false;
    int events = 0;
  };
  State at(Time time);

 private:
  void schedule(Time after);

  ShutterModel model_;
  Random random_;
  Time closes_, opens_;
  int events_ = 0;
};

}  // namespace pllit
