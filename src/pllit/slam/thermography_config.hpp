// What a user may set of the thermographic stage.
#pragma once

#include <optional>

#include "pllit/map/anchor.hpp"
#include "pllit/map/anomalies.hpp"
#include "pllit/map/radiometry.hpp"
#include "pllit/map/recent_surface.hpp"
#include "pllit/map/visit_changes.hpp"

namespace pllit {

/// What the camera's numbers are, or by their depth: 8-bit images are greys, others counts. Light is no heat, whatever
/// its numbers: thermography is not for it.
enum class UnitChoice { automatic, grey, count, kelvin, light };

struct ThermographyConfig {
  UnitChoice unit_choice = UnitChoice::automatic;
  /// What the camera's numbers are, and with it what may be claimed, as by_unit() was told. Greys and counts tell of
  /// changes only.
  IntensityUnit unit = IntensityUnit::grey;
  double kelvin_per_count = 0.01, kelvin_at_zero = 0.0;  ///< of radiometric images
  double counts_per_kelvin = 0.0;                        ///< of raw counts, as the user knows them; 0: not known
  Radiometry radiometry;                                 ///< of their scene
  double saturated_grey = 240.0;                         ///< from here on, greys of 8-bit video say "at least"
  SamplingConfig sampling;
  ThermalMapConfig map;
  AnchorConfig anchor;
  std::optional<AnchorConfig::Shape> anchor_choice;  ///< else by_unit() takes the one that suits the unit
  SightConfig sights;
  AnomalyConfig anomalies;
  RecentSurfaceConfig surface;
  int scan_points = 24000;        ///< of each scan, evenly, at most: the voxels of the surface hold one each
  int scans = 3;                  ///< so many scans together tell what is no longer there
  double time_constant_s = 0.01;  ///< of a bolometer's pixels; 0 for other sensors
  double shutter_pause_s = 0.5;   ///< images this soon after the shutter opened do not count
};

/// A configuration whose thresholds are open, that is zero (seam_voxels: negative): by_unit() is to fill them in.
ThermographyConfig open_thresholds();

/// What images with so many bits a pixel count.
IntensityUnit unit_of(const ThermographyConfig& config, bool eight_bits);

/// With the thresholds that suit images in this unit, where they are open: greys are tied to the map by a curve that is
/// good to a few greys only, so that a change must be large, old and more than all that is alike or near has changed;
/// counts and temperatures are good to a third of a kelvin.
ThermographyConfig by_unit(ThermographyConfig config, IntensityUnit unit);

/// How visits with images like these are compared; `config` as by_unit() gives it.
VisitChangesConfig visit_changes_config(const ThermographyConfig& config);

}  // namespace pllit
