// Fewer points, evenly spread.
#pragma once

#include "pllit/geometry/voxel_table.hpp"
#include "pllit/lidar/deskew.hpp"

namespace pllit {

struct ScanConfig {
  double insert_voxels = 0.5;  ///< spacing of the points that enter the map, in map voxels
  double match_voxels = 1.25;  ///< spacing of the points that are matched, in map voxels
  int min_matched = 600;       ///< where fewer remain, in narrow rooms, the spacing is reduced
  int max_matched = 2500;      ///< at most so many are matched
};

/// Keeps points at least `spacing_m` apart. Points are visited in a fixed scattered order: along the scan, the next one
/// kept would be the first whose noise takes it far enough from the last one, which turns every slanting wall in the
/// scanner's sense. (One point a voxel would do for less, but where a wall lies near the border of two voxels it
/// favours the noisy points on the far side and so moves it.)
PointCloud downsample(const PointCloud& cloud, double spacing_m);

/// The same with a spacing that is reduced, to a quarter at least, until `least` points remain.
PointCloud downsample(const PointCloud& cloud, double spacing_m, std::size_t least);

/// Keeps at most `count` points, evenly by index.
PointCloud thin(PointCloud cloud, std::size_t count);

/// Remembers which voxels of the world have been seen, within a radius, and tells the points that fall into new ones:
/// the map that is written to disk holds each place once, in bounded memory.
class FreshVoxels {
 public:
  FreshVoxels(double voxel_m, double radius_m) : voxel_m_(voxel_m), radius_m_(radius_m) {}

  /// Indices of the points that are the first in their voxel.
  /// Voxels farther than the radius from `centre_W` are forgotten.
  std::vector<std::size_t> select(const std::vector<Vector3f>& points_W, const Vector3d& centre_W);

 private:
  struct Seen {};
  double voxel_m_, radius_m_;
  VoxelTable<Seen> seen_;
  Vector3d last_centre_W_ = Vector3d::Zero();
};

}  // namespace pllit
