// What a user may set of the thermographic stage.
#pragma once

#include "pllit/map/anchor.hpp"
#include "pllit/map/anomalies.hpp"
#include "pllit/map/radiometry.hpp"
#include "pllit/map/recent_surface.hpp"

namespace pllit {

struct ThermographyConfig {
  /// What the camera's numbers are, and with it what may be claimed. Greys and counts tell of changes only.
  IntensityUnit unit = IntensityUnit::grey;
  double kelvin_per_count = 0.01, kelvin_at_zero = 0.0;  ///< of radiometric images
  Radiometry radiometry;                                 ///< of their scene
  double saturated_grey = 240.0;                         ///< from here on, greys of 8-bit video say "at least"
  SamplingConfig sampling;
  ThermalMapConfig map;
  AnchorConfig anchor;
  SightConfig sights;
  AnomalyConfig anomalies;
  RecentSurfaceConfig surface;
  int scan_points = 24000;        ///< of each scan, evenly, at most: the voxels of the surface hold one each
  int scans = 3;                  ///< so many scans together tell what is no longer there
  double time_constant_s = 0.01;  ///< of a bolometer's pixels; 0 for other sensors
  double shutter_pause_s = 0.5;   ///< images this soon after the shutter opened do not count
};

}  // namespace pllit
