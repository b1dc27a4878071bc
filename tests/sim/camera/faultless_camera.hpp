// A thermal camera that adds nothing to what it sees, for tests.
#pragma once

#include "pllit/sim/camera/thermal_camera.hpp"
#include "sim/camera/test_place.hpp"

namespace pllit {

/// Counts are linear in radiance; no noise, pattern, shutter, blur or vignetting.
inline ThermalCameraModel faultless_camera(double counts_per_K) {
  ThermalCameraModel model;
  model.camera = small_camera();
  model.blur_sigma_px = model.vignetting = model.netd_K = 0.0;
  model.counts_per_K = counts_per_K;
  model.fixed_pattern = kNoFixedPattern;
  model.shutter = {.least_interval_s = 1e6, .most_interval_s = 1e6, .least_freeze_s = 0.0, .most_freeze_s = 0.0};
  return model;
}

}  // namespace pllit
