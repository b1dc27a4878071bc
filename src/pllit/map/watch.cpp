#include "pllit/map/watch.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pllit/geometry/voxel_neighbours.hpp"
#include "pllit/map/surroundings.hpp"

namespace pllit {
namespace {

/// Calls visit(voxel) for the voxels around one that are older than a time and not watched themselves.
template <class Visit>
void for_older_neighbours(const ThermalMap& map, const Watch& watch, VoxelKey key, int reach, Time before,
                          const Visit& visit) {
  constexpr std::uint32_t kFewest = 3;  // images
  for_neighbours(key, reach, [&](VoxelKey next) {
    const ThermalVoxel* voxel = next == key ? nullptr : map.find(next);
    if (voxel && voxel->first_seen < before && voxel->images >= kFewest && !watch.contains(next)) visit(*voxel);
  });
}

/// Whether something next to it has always been nearly as hot: calibration is good to a few pixels only.
bool explained_by_neighbours(const ThermalMap& map, const Watch& watch, VoxelKey key, float hot, float change,
                             Time before, const WatchConfig& config) {
  bool explained = false;
  for_older_neighbours(map, watch, key, config.seam_voxels, before, [&](const ThermalVoxel& voxel) {
    if (voxel.mean > hot - 0.5F * change) explained = true;
  });
  return explained;
}

/// What a new surface is compared with.
struct Normal {
  float value, sigma;
};

/// By the older surfaces around; nothing where there are too few.
std::optional<Normal> surroundings(const ThermalMap& map, const Watch& watch, VoxelKey key, Time before,
                                   const WatchConfig& config) {
  std::vector<double> values;
  for_older_neighbours(map, watch, key, config.surround_voxels, before,
                       [&](const ThermalVoxel& voxel) { values.push_back(static_cast<double>(voxel.mean)); });
  const auto around = surroundings_of(std::move(values));
  if (!around) return std::nullopt;
  return Normal{static_cast<float>(around->upper),
                static_cast<float>(std::max(map.config().model.noise, around->spread))};
}

/// What a voxel that is no older than the heat in it should be, where that can be told.
std::optional<Normal> normal_of_new(const WatchInput& input, const Watch& watch, VoxelKey key,
                                    const ThermalVoxel& voxel, Time before, const WatchConfig& config) {
  const SightEvidence evidence = input.past.evidence(input.map.position_W(key, voxel), before);
  if (!evidence.was_free()) return std::nullopt;
  return surroundings(input.map, watch, key, before, config);
}

/// A quick look before all that: is it hotter than most of the image?
float level_of(const WatchInput& input) {
  std::vector<float> values;
  for (const VoxelKey key : input.seen) values.push_back(input.map.find(key)->present());
  if (values.empty()) return 0.0F;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 2 / 5);
  std::ranges::nth_element(values, at);
  return *at;
}

bool hot_against(float value, const Normal& normal, const VoxelModelConfig& model) {
  return value - normal.value >
         std::max(static_cast<float>(model.min_change), static_cast<float>(model.gate_sigmas) * normal.sigma);
}

void note_heat(WatchedVoxel& watched, float value, Time time) {
  watched.change = value - watched.normal;
  watched.peak = std::max(watched.peak, watched.change);
  watched.last = time;
  watched.hot = true;
  ++watched.hits;
}

/// A voxel with a past that its own model calls hot.
void take_in_known(Watch& watch, VoxelKey key, const ThermalVoxel& voxel, const WatchInput& input,
                   const WatchConfig& config) {
  const float change = voxel.changed_mean - voxel.mean;
  if (explained_by_neighbours(input.map, watch, key, voxel.changed_mean, change, voxel.change_since, config)) return;
  WatchedVoxel watched{.since = voxel.change_since,
                       .hits = voxel.changes - 1,
                       .normal = voxel.mean,
                       .sigma = voxel.sigma(input.map.config().model),
                       .position_W = input.map.position_W(key, voxel)};
  note_heat(watched, voxel.changed_mean, voxel.last_seen);
  watch.emplace(key, watched);
}

/// A watched voxel next to one, of which it may be a part.
const WatchedVoxel* hot_neighbour(const Watch& watch, VoxelKey key, float value, const VoxelModelConfig& model) {
  const WatchedVoxel* part = nullptr;
  for_neighbours(key, 1, [&](VoxelKey next) {
    const auto found = part ? watch.end() : watch.find(next);
    if (found == watch.end() || !found->second.hot) return;
    const float change = value - found->second.normal;
    if (change > static_cast<float>(model.min_change) && change > 0.5F * found->second.change) part = &found->second;
  });
  return part;
}

/// A voxel that was not there before.
void take_in_new(Watch& watch, VoxelKey key, const ThermalVoxel& voxel, const WatchInput& input,
                 const WatchConfig& config) {
  const VoxelModelConfig& model = input.map.config().model;
  const Time before = voxel.first_seen - from_seconds(config.evidence_lead_s);
  WatchedVoxel watched{.new_surface = true,
                       .since = voxel.first_seen,
                       .hits = static_cast<int>(voxel.images) - 1,
                       .position_W = input.map.position_W(key, voxel)};
  const auto at = [&](int times) { return voxel.images == static_cast<std::uint32_t>(times * model.hits); };
  if (const WatchedVoxel* part = hot_neighbour(watch, key, voxel.mean, model)) {
    watched.joined = true;
    watched.normal = part->normal;
    watched.sigma = part->sigma;
  } else if (at(1) || at(2)) {
    const auto normal = normal_of_new(input, watch, key, voxel, before, config);
    if (!normal || !hot_against(voxel.mean, *normal, model)) return;
    if (explained_by_neighbours(input.map, watch, key, voxel.mean, voxel.mean - normal->value, before, config)) return;
    watched.normal = normal->value;
    watched.sigma = normal->sigma;
  } else {
    return;
  }
  note_heat(watched, voxel.mean, voxel.last_seen);
  watch.emplace(key, watched);
}

/// A watched voxel seen again.
void follow(WatchedVoxel& watched, VoxelKey key, const ThermalVoxel& voxel, const ThermalMap& map) {
  const VoxelModelConfig& model = map.config().model;
  watched.position_W = map.position_W(key, voxel);
  const float now = voxel.present();
  const float release = static_cast<float>(model.release_sigmas) * watched.sigma;
  const bool hot = watched.new_surface ? now - watched.normal > release : voxel.hot;
  if (hot && !watched.hot) watched.since = voxel.last_seen;  // heated anew
  if (hot)
    note_heat(watched, now, voxel.last_seen);
  else
    watched.hot = false;
}

/// Surfaces that this image sees through are no longer there.
void notice_leaving(Watch& watch, const WatchInput& input) {
  constexpr int kSure = 2;
  for (auto& [key, watched] : watch) {
    if (watched.vacated) continue;
    const PointSight sight = look_around(input.sight, watched.position_W, input.past.config());
    if (sight == PointSight::surface) watched.seen_through = 0;
    if (sight != PointSight::free || ++watched.seen_through < kSure) continue;
    watched.vacated = true;
    watched.hot = false;
  }
}

}  // namespace

Watch watched(Watch watch, const WatchInput& input, const WatchConfig& config) {
  const VoxelModelConfig& model = input.map.config().model;
  const float level = level_of(input);
  for (const VoxelKey key : input.seen) {
    const ThermalVoxel& voxel = *input.map.find(key);
    if (const auto found = watch.find(key); found != watch.end()) {
      if (!found->second.vacated) follow(found->second, key, voxel, input.map);
    } else if (voxel.hot) {
      take_in_known(watch, key, voxel, input, config);
    } else if (!voxel.learned(model) && voxel.images >= static_cast<std::uint32_t>(model.hits) &&
               voxel.mean - level > static_cast<float>(model.min_change)) {
      take_in_new(watch, key, voxel, input, config);
    }
  }
  notice_leaving(watch, input);
  std::erase_if(watch, [&](const auto& entry) {
    const auto& [key, watched] = entry;
    if (!input.map.find(key)) return true;
    return watched.owner == 0 && (!watched.hot || to_seconds(input.sight.time - watched.last) > config.forget_s);
  });
  return watch;
}

}  // namespace pllit
