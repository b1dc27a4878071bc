// A monochrome camera with automatic exposure.
#pragma once

#include <deque>

#include "pllit/sim/camera/expose.hpp"
#include "pllit/sim/random.hpp"

namespace pllit {

/// Automatic exposure: what it aims at, how far it can go, how late and how fast.
struct AutoExposure {
  double target = 0.35;  ///< mean of the image before gamma, of full scale
  double least_s = 2e-5, most_s = 0.02;
  double most_gain = 8.0;  ///< used only where the longest exposure is not enough
  int delay_frames = 2;    ///< between an image and the exposure that it leads to
  double speed = 0.5;      ///< share of the missing stops made good with each image
};

struct VisibleCameraModel {
  Camera camera;
  double rate_hz = 10.0;
  int samples = 4;               ///< of each pixel, over its area and the time of exposure; see sampling_for()
  double blur_sigma_px = 0.5;    ///< of the optics
  double vignetting = 0.3;       ///< share of the light lost in the corners
  double full_well_e = 10000.0;  ///< electrons at full scale with gain 1
  double full_light_s = 0.002;   ///< exposure in which a white surface in full light fills the well
  double read_noise_e = 6.0;
  double gamma = 1.6;  ///< grey = 255 signal^(1/gamma)
  AutoExposure exposure;
};

struct VisibleFrame {
  Time time;     ///< middle of the exposure
  cv::Mat grey;  ///< CV_8UC1
  double exposure_s = 0.0, gain = 1.0;
};

/// Frames are to be asked for in order of time. The same arguments give the same bytes for any number of threads.
class VisibleCamera {
 public:
  /// start: of the motion, from which the actors' paths count. The place must outlive the camera.
  VisibleCamera(const VisibleCameraModel& model, const Place& place, Time start, std::uint64_t seed);

  /// One image with the middle of its exposure at `time`. The caster has been moved to the camera's position at about
  /// that time.
  VisibleFrame capture(const RayCaster& caster, const CameraPath& path, Time time, Arena& arena);

  const VisibleCameraModel& model() const { return model_; }

 private:
  VisibleCameraModel model_;
  const Place* place_;
  Time start_;
  RayTable rays_;
  Random random_;
  std::deque<double> planned_;  ///< exposure times gain, s, of the next frames
};

}  // namespace pllit
