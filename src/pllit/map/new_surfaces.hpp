// What a surface that was not there before should be: what its surroundings are.
#pragma once

#include <map>
#include <optional>

#include "pllit/geometry/voxel_neighbours.hpp"
#include "pllit/map/watch.hpp"

namespace pllit {

/// What a new surface is compared with.
struct Normal {
  float value, sigma;
};

inline bool was_there(const ThermalVoxel& voxel, Time before) {
  constexpr std::uint32_t kFewest = 3;  // images
  return voxel.first_seen < before && voxel.images >= kFewest;
}

/// The new surfaces of one image.
class NewSurfaces {
 public:
  /// All are to outlive it.
  NewSurfaces(const WatchInput& input, const Watch& watch, const WatchConfig& config)
      : input_(input), watch_(watch), config_(config) {}

  /// Where earlier sights, before a time, saw through the place where a voxel now is: by the surfaces next to it that
  /// are older, or where those are too few by those around it in the image, for what stands behind it was to be seen in
  /// its place. Where what came is seen only later, the first of it finds none around that are older: it is compared
  /// with those that sights have always met. Nothing where all these are too few.
  std::optional<Normal> normal(VoxelKey key, const ThermalVoxel& voxel, Time before);

 private:
  template <class Counts>
  std::optional<Normal> surroundings(VoxelKey key, const Counts& counts) const;
  bool always_stood(VoxelKey key, const ThermalVoxel& voxel);

  const WatchInput& input_;
  const Watch& watch_;
  const WatchConfig& config_;
  std::map<VoxelKey, bool> stood_;  ///< what always_stood found: it takes its time
};

}  // namespace pllit
