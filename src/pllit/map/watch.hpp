// The voxels that are hotter than they should be: the first stages of detection, voxel by voxel.
#pragma once

#include <map>

#include "pllit/map/sight_log.hpp"
#include "pllit/map/thermal_map.hpp"

namespace pllit {

struct WatchConfig {
  double forget_s = 5.0;         ///< voxels that belong to no anomaly are forgotten when not seen hot for so long
  double least_past_s = 5.0;     ///< for so long a surface was known when it changed: within one look, views change
  int seam_voxels = 2;           ///< so near, heat that has always been explains a change: images lie a few pixels off
  double seam_lead_s = 3.0;      ///< ... and so does what was as bright at times, so long before at least
  int surround_voxels = 8;       ///< how far around a surface its surroundings are looked at ...
  double surround_deg = 10.0;    ///< ... and in the image, where little is known around a new one
  bool bent_curves = true;       ///< images are tied by curves, which may be off for all that is alike or near
  bool whole_things = false;     ///< what is next to something hot is a part of it if hot by less; see take_in_parts
  double part_share = 1.0;       ///< of the least change that makes a part ...
  int part_voxels = 1;           ///< ... so near ...
  int parts_of_one = 5;          ///< so many voxels to one that is judged by itself: a mistake must not take in a wall
  double part_lead_s = 1.0;      ///< ... and known no longer than so before the thing was last seen cool, or came
  double evidence_lead_s = 0.5;  ///< sights so shortly before a surface was first seen do not speak of it
};

/// A voxel that is or was hot.
struct WatchedVoxel {
  bool new_surface = false;  ///< against its surroundings; else against its own past
  bool joined = false;       ///< a part of what is hot: next to it, and hot by less, or without a past of its own
  bool hot = false;
  bool vacated = false;      ///< seen through since: the surface has left
  Time since{}, last{};      ///< first and last image of this heat
  Time cool{};               ///< it was not hot yet
  Time taken_in{};           ///< of parts: when they became one
  Time seen{};               ///< last image that showed it, hot or not
  int hits = 0;              ///< images that showed it
  int seen_through = 0;      ///< images in a row
  float normal = 0.0F;       ///< what it should be
  float sigma = 0.0F;        ///< standard deviation of that
  float change = 0.0F;       ///< against it, the last one seen hot
  float peak = 0.0F;         ///< the greatest
  float seed_change = 0.0F;  ///< of parts: of the one that was judged by itself, from which they were reached
  float sure = 0.0F;         ///< the most that was left of it however the surface lies to the edges of the image
  std::uint32_t owner = 0;   ///< anomaly that it belongs to; 0: none
  Vector3d position_W = Vector3d::Zero();

  double dwell_s() const { return to_seconds(last - since); }
};

/// What one image brought.
struct WatchInput {
  const ThermalMap& map;
  std::span<const VoxelKey> seen;  ///< in this image
  const Sight& sight;              ///< of the last scans
  const SightLog& past;
  double spread = 0.0;  ///< of the image's intensities about what is known, one sigma
};

/// All watched voxels, in a fixed order.
using Watch = std::map<VoxelKey, WatchedVoxel>;

/// The watch after one more image. A voxel is taken in
/// - where its own past is known: when its change has lasted as the voxel's model demands, began no sooner after the
///   surface came into sight than a look takes, is more than the surfaces around have changed with it, and more than
///   what its neighbours' pasts explain (a seam that is seen a few pixels off, or shows now the one side and now the
///   other), and
/// - where it is a new surface: when it is hotter than its surroundings, which is what was to be seen through the place
///   where it now is, and earlier sights did see through that; what they did not may have been hot for ever, unless it
///   is part of a watched thing: see take_in_parts.
/// It cools when its model says so, and leaves when it is seen through.
Watch watched(Watch watch, const WatchInput& input, const WatchConfig& config);

}  // namespace pllit
