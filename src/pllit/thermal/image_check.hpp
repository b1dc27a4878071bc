// Which images are worth looking at: a thermal camera's shutter freezes its video, and links repeat images.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "pllit/geometry/camera.hpp"
#include "pllit/sensor/measurements.hpp"

namespace pllit {

struct ImageCheckConfig {
  double changed_share = 0.002;       ///< an image is a repetition where fewer of its pixels differ from the last one's
  double least_spread_grey = 4.0;     ///< between the quantiles at 5 and 95 %, of 8-bit images; less is blank
  double least_spread_counts = 10.0;  ///< likewise, of 16-bit images
  double clipped_share = 0.5;         ///< at either end of the range together; more is saturated
  double dark_grey = 5.0, bright_grey = 250.0;  ///< an 8-bit image whose median lies beyond is too dark or too bright
  int shutter_images = 2;                       ///< so many repetitions on end, or
  Duration shutter_time = from_seconds(0.2);    ///< images that repeat for so long, are a shutter event
};

/// What the check remembers of the images before: the last one that was not a repetition.
struct ImageHistory {
  cv::Mat counts;       ///< empty before the first image
  Time time;            ///< when it was taken
  int repetitions = 0;  ///< of it, so far
};

struct ImageVerdict {
  enum class Kind { good, repeated, blank, saturated, dark, bright, unknown_format };
  Kind kind = Kind::good;
  std::string reason;          ///< in words; empty for a good image
  bool after_shutter = false;  ///< the first image after a shutter event: greys before it say nothing about those after

  bool usable() const { return kind == Kind::good; }
};

/// Judges one image. A repetition is one that equals the last image but for a share of its pixels that noise alone
/// exceeds in any live image.
ImageVerdict judge(const CameraFrame& frame, const ImageHistory& before, const ImageCheckConfig& config);

/// Whether an image is as large as those that the camera was calibrated with; if not, an input error with both sizes.
Expected<void> fits(const cv::Mat& counts, const Camera& camera);

/// The history to judge the next image with.
ImageHistory remembered(const CameraFrame& frame, const ImageVerdict& verdict, const ImageHistory& before);

}  // namespace pllit
