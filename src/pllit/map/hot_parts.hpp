// What hangs together with what is hot.
#pragma once

#include <vector>

#include "pllit/map/watch.hpp"

namespace pllit {

/// Takes into the watch what is a part of something hot: next to it, and at least half as hot as its voxels that were
/// judged by themselves are in the mean,
/// - without a cool past of its own, because it came into sight when the thing was hot already, or
/// - with config.whole_things, known, and hotter by config.part_share of the least change; then also what earlier
/// images
///   showed and this one does not, up to twice the parts that config.parts_of_one allows for.
/// `fresh` are the voxels that this image has brought.
void take_in_parts(Watch& watch, std::vector<VoxelKey> fresh, const WatchInput& input, const WatchConfig& config);

/// Takes note that a watched voxel is seen hot.
void note_heat(WatchedVoxel& watched, const ThermalVoxel& voxel);

/// The least change of a part.
inline float part_change(const VoxelModelConfig& model, const WatchConfig& config) {
  return static_cast<float>(config.part_share * model.min_change);
}

}  // namespace pllit
