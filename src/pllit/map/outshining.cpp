#include "pllit/map/outshining.hpp"

#include <algorithm>
#include <iterator>

#include "pllit/base/evenly.hpp"

namespace pllit {

std::vector<CalmSurface> calm_surfaces(const WatchInput& input, const Watch& watch) {
  constexpr std::size_t kEnough = 2000;
  std::vector<CalmSurface> calm;
  for (const VoxelKey key : input.seen) {
    const ThermalVoxel& voxel = *input.map.find(key);
    if (voxel.learned(input.map.config().model) && !watch.contains(key)) calm.push_back({voxel.mean, voxel.raw});
  }
  return evenly(calm, kEnough);
}

std::optional<double> outshone(std::span<WatchedVoxel* const> parts, std::span<const CalmSurface> calm,
                               const ThermalMap& map, Time now) {
  constexpr std::size_t kEnough = 50;
  std::vector<const WatchedVoxel*> seeds;
  std::ranges::copy_if(parts, std::back_inserter(seeds),
                       [now](const WatchedVoxel* part) { return part->hot && !part->joined && part->last == now; });
  std::vector<double> shares;
  for (const WatchedVoxel* part : evenly(seeds, kEnough)) {
    const ThermalVoxel* voxel = map.find(map.key_at(part->position_W));
    if (!voxel) continue;
    int brighter = 0, darker_now = 0;
    for (const CalmSurface& surface : calm) {
      if (surface.normal <= part->normal) continue;
      ++brighter;
      darker_now += surface.raw < voxel->raw ? 1 : 0;
    }
    if (brighter > 0) shares.push_back(static_cast<double>(darker_now) / brighter);
  }
  if (shares.empty()) return std::nullopt;
  const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
  std::ranges::nth_element(shares, middle);
  return *middle;
}

}  // namespace pllit
