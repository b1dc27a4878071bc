#include "pllit/map/seen_space.hpp"

#include <algorithm>

#include "pllit/geometry/voxel_neighbours.hpp"

namespace pllit {

SeenSpace::SeenSpace(std::span<const Sightline> lines_W, const SeenSpaceConfig& config) {
  const double per_m = 1.0 / config.voxel_m;
  const auto step_m = static_cast<float>(0.7 * config.voxel_m);
  for (const Sightline& line : lines_W) {
    cells_.insert(voxel_key(voxel_of(line.to_W, per_m))).first->surface = true;
    const Vector3f way_m = line.to_W - line.from_W;
    const float length_m = way_m.norm();
    const float end_m = std::min(length_m - static_cast<float>(config.behind_m), static_cast<float>(config.reach_m));
    for (float at_m = 0.0F; at_m < end_m; at_m += step_m)
      cells_.insert(voxel_key(voxel_of(Vector3f(line.from_W + at_m / length_m * way_m), per_m))).first->free = true;
  }
}

bool SeenSpace::surface_at(VoxelKey key) const {
  bool found = false;
  for_neighbours(key, 1, [&](VoxelKey next) {
    const Cell* cell = cells_.find(next);
    found = found || (cell && cell->surface);
  });
  return found;
}

bool SeenSpace::looked_through(VoxelKey key) const {
  const Cell* cell = cells_.find(key);
  return cell && cell->free;
}

double SeenSpace::share_in(const SeenSpace& other) const {
  int surfaces = 0, shared = 0;
  cells_.for_each([&](VoxelKey key, const Cell& cell) {
    if (!cell.surface) return;
    ++surfaces;
    shared += other.surface_at(key) ? 1 : 0;
  });
  return static_cast<double>(shared) / std::max(1, surfaces);
}

}  // namespace pllit
