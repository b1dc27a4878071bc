// The memory of one surface voxel: what intensity is normal there, and what has lately been seen instead.
#pragma once

#include <cstdint>

#include "pllit/base/time.hpp"
#include "pllit/geometry/lie.hpp"

namespace pllit {

struct VoxelModelConfig {
  double noise = 6.0;             ///< least standard deviation: sensor, calibration, rounding; in the map's unit
  int learned_after = 12;         ///< images before a voxel's normal intensity is known
  int learned_views = 2;          ///< from so many viewpoints, or in five times as many images where the rig stands
  int passing_images = 4;         ///< or after so many, when the rig has gone by and ...
  double passing_s = 5.0;         ///< ... comes back after so long
  double adaptation = 0.02;       ///< weight of each later image: the normal intensity fades in 50 images
  double gate_sigmas = 3.0;       ///< beyond this an image does not count as normal
  double min_change = 30.0;       ///< nor does it beyond this, and a smaller change is never hot; in the map's unit
  double saturated_doubt = 60.0;  ///< one sigma of what is learned from saturated pixels; in the map's unit
  double release_sigmas = 2.0;    ///< what is hot stays so until it is within this
  int hits = 3;                   ///< images that must have shown a change
};

/// What one image showed of a voxel: the mean over its points there.
struct VoxelSample {
  Time time;
  Vector3f viewpoint_W;
  Vector3f offset_m;  ///< mean of the points from the voxel's centre
  float intensity = 0.0F, raw = 0.0F;
  float dip = 0.0F, rise = 0.0F;  ///< how much less and more the image shows close by
  float doubt = 0.0F;             ///< of the calibration, one sigma
  float saturated = 0.0F;         ///< share of the points that are at least so bright
  float spread = 0.0F;            ///< of the image's intensities about what is known, one sigma
  int points = 1;
};

/// Normal intensity: mean and spread of the images so far, then exponential. An image that differs by more than the
/// gate goes to a short-term model instead, so that what has become hot does not become normal.
struct ThermalVoxel {
  Time first_seen, last_seen;
  Time normal_at;     ///< of the last image that showed nothing unusual
  Time change_since;  ///< of the short-term model; holds while changes > 0
  Vector3f last_viewpoint_W = Vector3f::Zero();
  Vector3f offset_sum_m = Vector3f::Zero();  ///< of the points from the voxel's centre
  float points = 0.0F;
  float mean = 0.0F, squares = 0.0F;  ///< squares: sum of squared deviations, or their weighted mean once learned
  float dip = 0.0F, rise = 0.0F;      ///< means of those of the images that it was learned from
  float doubt = 0.0F;                 ///< of the calibration that the mean was learned with, one sigma
  float saturated = 0.0F;             ///< share of what it was learned from that was at least so bright
  float changed_mean = 0.0F, changed_dip = 0.0F;  ///< short-term model
  float last = 0.0F;                              ///< what the last image showed
  float brightest = 0.0F;                         ///< the most that two images in a row showed
  Time brightest_at;                              ///< when they did; Time{} where none did yet
  float raw = 0.0F;                               ///< of the last image, as the camera gave it, for human eyes
  std::uint32_t images = 0;
  std::uint16_t views = 0;    ///< viewpoints a quarter of a metre apart
  std::uint16_t changes = 0;  ///< images in the short-term model
  std::uint8_t calm = 0;      ///< normal images in a row since
  bool passed = false;        ///< the rig went by and has come back
  bool hot = false;

  bool learned(const VoxelModelConfig& config) const {
    const auto enough = static_cast<std::uint32_t>(passed ? config.passing_images : config.learned_after);
    return images >= (views >= config.learned_views ? enough : 5 * enough);
  }
  /// Of the images that were normal.
  float variance(const VoxelModelConfig& config) const;
  /// Standard deviation of what is normal, with the doubts of calibration and saturation; at least the configured
  /// noise, and more where few images showed it.
  float sigma(const VoxelModelConfig& config) const;
  /// How much of a change is left where what was read lay on the less hot side of an edge, and what was normal on the
  /// hotter one: of a known surface, and of one against a normal intensity.
  float sure_change() const { return (changed_mean - changed_dip) - (mean + rise); }
  float sure_change_from(float normal) const { return mean - dip - normal; }
  /// What is to be expected now: the short-term mean once several images have shown a change, else the normal one.
  float present() const { return changes >= 3 ? changed_mean : mean; }
};

/// The voxel after one more image.
ThermalVoxel seen(ThermalVoxel voxel, const VoxelSample& sample, const VoxelModelConfig& config);

}  // namespace pllit
