// An uncooled thermal camera, from radiance to counts and video.
#pragma once

#include <optional>

#include "pllit/sim/camera/agc.hpp"
#include "pllit/sim/camera/expose.hpp"
#include "pllit/sim/camera/fixed_pattern.hpp"
#include "pllit/sim/camera/heat.hpp"

namespace pllit {

struct ThermalCameraModel {
  Camera camera;
  double rate_hz = 25.0;
  double time_constant_s = 0.010;  ///< of the bolometers
  int samples = 4;                 ///< of each pixel, over its area and the time of exposure; see sampling_for()
  double blur_sigma_px = 0.7;      ///< of the optics
  double vignetting = 0.06;        ///< share of the scene's radiance that the housing takes the place of in the corners
  double housing_K = 303.0;
  double counts_per_K = 30.0;  ///< at 300 K; counts are linear in radiance
  double counts_at_300K = 7000.0;
  int bits = 14;
  double netd_K = 0.05;  ///< white noise, sigma, for a scene at 300 K
  FixedPatternModel fixed_pattern;
  ShutterModel shutter;
  AgcConfig agc;
};

struct ThermalFrame {
  Time time;            ///< of readout; the scene is seen one time constant earlier on average
  cv::Mat counts;       ///< CV_16UC1
  cv::Mat grey;         ///< CV_8UC1, the same after gain control
  bool frozen = false;  ///< the shutter is closed: both repeat the last image
};

/// Frames are to be asked for in order of time. The recipe: rays through the camera model over pixel and time, blur of
/// the optics, vignetting, counts, fixed pattern that walks between shutter events, noise, gain control. The same
/// arguments give the same bytes for any number of threads.
class ThermalCamera {
 public:
  /// start: of the motion, from which the place's heat counts. The place must outlive the camera. Sub-streams of `seed`
  /// are used.
  ThermalCamera(const ThermalCameraModel& model, const Place& place, Time start, std::uint64_t seed);

  /// One image read out at `time`. The caster has been moved to the camera's position at about that time.
  ThermalFrame capture(const RayCaster& caster, const CameraPath& path, Time time, Arena& arena);

  const ThermalCameraModel& model() const { return model_; }

 private:
  cv::Mat counts(const RayCaster& caster, const CameraPath& path, Time time, Arena& arena);

  ThermalCameraModel model_;
  const Place* place_;
  Time start_;
  RayTable rays_;
  ThermalBand band_;
  Random random_;
  FixedPattern pattern_;
  Shutter shutter_;
  GreyMapping mapping_;
  int shutter_events_ = -1;  ///< before the one at power-on
  std::optional<ThermalFrame> last_;
};

}  // namespace pllit
