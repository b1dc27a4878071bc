#include "pllit/map/new_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pllit/map/surroundings.hpp"

namespace pllit {

std::optional<Normal> NewSurfaces::normal(VoxelKey key, const ThermalVoxel& voxel, Time before) {
  const SightEvidence evidence = input_.past.evidence(input_.map.position_W(key, voxel), before);
  if (!evidence.was_free()) return std::nullopt;
  const auto older = surroundings(key, [&](VoxelKey, const ThermalVoxel& around) { return was_there(around, before); });
  if (older || !evidence.came) return older;
  return surroundings(key, [&](VoxelKey next, const ThermalVoxel& around) { return always_stood(next, around); });
}

/// By those of the surfaces around that count.
template <class Counts>
std::optional<Normal> NewSurfaces::surroundings(VoxelKey key, const Counts& counts) const {
  const ThermalMap& map = input_.map;
  std::vector<double> values;
  const auto add = [&](VoxelKey next) {
    const ThermalVoxel* around = next == key || watch_.contains(next) ? nullptr : map.find(next);
    if (around && counts(next, *around)) values.push_back(static_cast<double>(around->mean));
  };
  for_neighbours(key, config_.surround_voxels, add);
  auto found = surroundings_of(values);
  if (!found) {
    const double least_cos = std::cos(config_.surround_deg * std::numbers::pi / 180.0);
    const auto ray_W = [&](VoxelKey of) -> Vector3d {
      return (map.position_W(of, *map.find(of)) - input_.sight.p_W).normalized();
    };
    const Vector3d towards_W = ray_W(key);
    values.clear();
    for (const VoxelKey seen : input_.seen)
      if (ray_W(seen).dot(towards_W) > least_cos) add(seen);
    found = surroundings_of(values);
  }
  if (!found) return std::nullopt;
  return Normal{static_cast<float>(found->upper),
                static_cast<float>(std::max(map.config().model.noise, found->spread))};
}

bool NewSurfaces::always_stood(VoxelKey key, const ThermalVoxel& voxel) {
  constexpr int kFewest = 3;  // sights, images
  const auto [at, is_new] = stood_.try_emplace(key, false);
  if (is_new && voxel.images >= static_cast<std::uint32_t>(kFewest)) {
    const SightEvidence evidence = input_.past.evidence(input_.map.position_W(key, voxel), voxel.first_seen);
    at->second = evidence.surface >= kFewest && !evidence.was_free();
  }
  return at->second;
}

}  // namespace pllit
