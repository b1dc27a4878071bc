// What a visit's LiDAR measured and what it looked through: the ways of light of all points that its map holds.
#pragma once

#include <cstdint>
#include <span>

#include "pllit/geometry/lie.hpp"
#include "pllit/geometry/voxel_table.hpp"

namespace pllit {

/// From where the LiDAR was to what it measured, in W; both the same where it is not known where the LiDAR was.
struct Sightline {
  Vector3f from_W, to_W;
};

struct SeenSpaceConfig {
  double voxel_m = 0.1;
  double behind_m = 0.2;  ///< a line looks through what lies at least so far before its end ...
  double reach_m = 12.0;  ///< ... and no farther away than this
};

class SeenSpace {
 public:
  SeenSpace(std::span<const Sightline> lines_W, const SeenSpaceConfig& config);

  /// Whether a point was measured in a voxel or one next to it.
  bool surface_at(VoxelKey key) const;
  /// Whether a line went through a voxel.
  bool looked_through(VoxelKey key) const;
  /// Share of the voxels in which this visit measured a point that are surfaces of another visit too.
  double share_in(const SeenSpace& other) const;

 private:
  struct Cell {
    bool surface = false, free = false;
  };
  VoxelTable<Cell> cells_;
};

}  // namespace pllit
