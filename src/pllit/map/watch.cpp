#include "pllit/map/watch.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pllit/base/evenly.hpp"
#include "pllit/map/hot_parts.hpp"
#include "pllit/map/new_surfaces.hpp"
#include "pllit/map/surroundings.hpp"

namespace pllit {
namespace {

/// Whether something next to it has always been nearly as hot, or at times: calibration is good to a few pixels only,
/// and what lies on a seam shows now the one side and now the other.
bool explained_by_neighbours(const ThermalMap& map, const Watch& watch, VoxelKey key, float hot, float change,
                             Time before, const WatchConfig& config) {
  bool explained = false;
  for_neighbours(key, config.seam_voxels, [&](VoxelKey next) {
    const ThermalVoxel* voxel = next == key ? nullptr : map.find(next);
    if (!voxel || !was_there(*voxel, before) || watch.contains(next)) return;
    const bool at_times =
        voxel->brightest_at != Time{} && voxel->brightest_at < before - from_seconds(config.seam_lead_s);
    if (voxel->mean > hot - 0.5F * change || (at_times && voxel->brightest > hot - 0.25F * change)) explained = true;
  });
  return explained;
}

/// A quick look before all that: is it hotter than most of the image?
float level_of(const WatchInput& input) {
  constexpr std::size_t kEnough = 1000;
  std::vector<float> values;
  for (const VoxelKey key : evenly(input.seen, kEnough)) values.push_back(input.map.find(key)->present());
  if (values.empty()) return 0.0F;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 2 / 5);
  std::ranges::nth_element(values, at);
  return *at;
}

bool hot_against(const ThermalVoxel& voxel, const Normal& normal, double spread, const VoxelModelConfig& model) {
  const float sigma = std::hypot(std::max(normal.sigma, static_cast<float>(spread)), voxel.doubt);
  return voxel.mean - normal.value >
         std::max(static_cast<float>(model.min_change), static_cast<float>(model.gate_sigmas) * sigma);
}

/// What was normal where a new voxel now is, if it is hot against that.
std::optional<Normal> cooler_before(const WatchInput& input, const Watch& watch, NewSurfaces& surfaces, VoxelKey key,
                                    const ThermalVoxel& voxel, const WatchConfig& config) {
  const VoxelModelConfig& model = input.map.config().model;
  if (voxel.images % static_cast<std::uint32_t>(model.hits) != 0) return std::nullopt;  // it takes time
  const Time before = voxel.first_seen - from_seconds(config.evidence_lead_s);
  const auto normal = surfaces.normal(key, voxel, before);
  if (!normal || !hot_against(voxel, *normal, input.spread, model)) return std::nullopt;
  if (voxel.sure_change_from(normal->value) < 0.0F) return std::nullopt;
  const float change = voxel.mean - normal->value;
  if (explained_by_neighbours(input.map, watch, key, voxel.mean, change, before, config)) return std::nullopt;
  return normal;
}

/// The median of (what this image shows) - (what is normal), of known surfaces; nothing where those are too few, or it
/// is a cooling.
float common_change(std::vector<double> changes) {
  const auto common = surroundings_of(std::move(changes));
  return common ? std::max(0.0F, static_cast<float>(common->median)) : 0.0F;
}

/// How much the known surfaces around a voxel that the same image shows have changed along with it, though none of them
/// by enough to count: what the image's curve could not take out, not heat.
float change_around(const WatchInput& input, const Watch& watch, VoxelKey key, const ThermalVoxel& voxel,
                    const WatchConfig& config) {
  std::vector<double> changes;
  for_neighbours(key, config.surround_voxels, [&](VoxelKey next) {
    const ThermalVoxel* around = next == key ? nullptr : input.map.find(next);
    if (around && around->last_seen == voxel.last_seen && around->learned(input.map.config().model) &&
        around->changes == 0 && !watch.contains(next))
      changes.push_back(static_cast<double>(around->last - around->mean));
  });
  return common_change(std::move(changes));
}

/// How much all that is normally as bright as a voxel has changed with it, as far as the image's curve can be off:
/// where few surfaces tie it, at its ends above all, it may run anywhere.
float change_of_alike(const WatchInput& input, const Watch& watch, const ThermalVoxel& voxel) {
  const VoxelModelConfig& model = input.map.config().model;
  const auto alike = static_cast<float>(model.min_change / 3.0), most = static_cast<float>(1.5 * model.min_change);
  std::vector<double> changes;
  for (const VoxelKey key : input.seen) {
    const ThermalVoxel& other = *input.map.find(key);
    if (other.learned(model) && !watch.contains(key) && std::abs(other.mean - voxel.mean) <= alike)
      changes.push_back(static_cast<double>(other.last - other.mean));
  }
  return std::min(most, common_change(std::move(changes)));
}

/// A voxel with a past that its own model calls hot.
void take_in_known(Watch& watch, VoxelKey key, const ThermalVoxel& voxel, const WatchInput& input,
                   const WatchConfig& config) {
  if (to_seconds(voxel.change_since - voxel.first_seen) < config.least_past_s) return;
  const VoxelModelConfig& model = input.map.config().model;
  const float change = voxel.changed_mean - voxel.mean, sigma = voxel.sigma(model);
  const float least = std::max(static_cast<float>(model.min_change), static_cast<float>(model.gate_sigmas) * sigma);
  if (config.bent_curves && change - change_around(input, watch, key, voxel, config) < least) return;
  if (config.bent_curves && change - change_of_alike(input, watch, voxel) < least) return;
  // What has come into sight since it was last normal may be the same heat, from another side.
  if (explained_by_neighbours(input.map, watch, key, voxel.changed_mean, change, voxel.normal_at, config)) return;
  WatchedVoxel watched{.since = voxel.change_since,
                       .cool = voxel.normal_at,
                       .hits = voxel.changes - 1,
                       .normal = voxel.mean,
                       .sigma = sigma,
                       .position_W = input.map.position_W(key, voxel)};
  note_heat(watched, voxel);
  watch.emplace(key, watched);
}

/// A voxel that was not there before and is hot by itself.
void take_in_new(Watch& watch, NewSurfaces& surfaces, VoxelKey key, const ThermalVoxel& voxel, const WatchInput& input,
                 const WatchConfig& config) {
  const auto normal = cooler_before(input, watch, surfaces, key, voxel, config);
  if (!normal) return;
  WatchedVoxel watched{.new_surface = true,
                       .since = voxel.first_seen,
                       .cool = voxel.first_seen,
                       .hits = static_cast<int>(voxel.images) - 1,
                       .normal = normal->value,
                       .sigma = normal->sigma,
                       .position_W = input.map.position_W(key, voxel)};
  note_heat(watched, voxel);
  watch.emplace(key, watched);
}

/// A part of a hot thing that is hot by itself, as far as can be known: it counts as one that was judged.
void judge_part(Watch& watch, NewSurfaces& surfaces, VoxelKey key, const ThermalVoxel& voxel, const WatchInput& input,
                const WatchConfig& config) {
  const auto normal = cooler_before(input, watch, surfaces, key, voxel, config);
  if (!normal) return;
  WatchedVoxel& part = watch.at(key);
  part.joined = false;
  part.normal = normal->value;
  part.sigma = normal->sigma;
}

bool still_hot(const WatchedVoxel& watched, const ThermalVoxel& voxel, const VoxelModelConfig& model,
               const WatchConfig& config) {
  if (watched.new_surface)
    return voxel.present() - watched.normal > static_cast<float>(model.release_sigmas) * watched.sigma;
  return voxel.hot || (watched.joined && voxel.last - watched.normal > 0.5F * part_change(model, config));
}

/// A watched voxel seen again.
void follow(WatchedVoxel& watched, VoxelKey key, const ThermalVoxel& voxel, const WatchInput& input,
            const WatchConfig& config) {
  watched.position_W = input.map.position_W(key, voxel);
  watched.seen = voxel.last_seen;
  if (!watched.new_surface && voxel.hot) watched.joined = false;  // by itself now
  const bool hot = still_hot(watched, voxel, input.map.config().model, config);
  if (hot && !watched.hot) watched.since = voxel.last_seen;  // heated anew
  if (hot)
    note_heat(watched, voxel);
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

/// Whether a voxel that the image shows has left. A coarse sight may have missed it for a while: a surface in its place
/// is it again.
bool is_away(WatchedVoxel& watched, const WatchInput& input) {
  if (watched.vacated && look_around(input.sight, watched.position_W, input.past.config()) == PointSight::surface) {
    watched.vacated = false;
    watched.seen_through = 0;
  }
  return watched.vacated;
}

}  // namespace

Watch watched(Watch watch, const WatchInput& input, const WatchConfig& config) {
  const VoxelModelConfig& model = input.map.config().model;
  const float level = level_of(input);
  NewSurfaces surfaces(input, watch, config);
  std::vector<VoxelKey> fresh;
  auto next = watch.begin();  // both ascend
  for (const VoxelKey key : input.seen) {
    const ThermalVoxel& voxel = *input.map.find(key);
    while (next != watch.end() && next->first < key) ++next;
    if (next != watch.end() && next->first == key) {
      WatchedVoxel& known = next->second;
      if (is_away(known, input)) continue;
      follow(known, key, voxel, input, config);
      if (known.hot && known.joined && known.new_surface) judge_part(watch, surfaces, key, voxel, input, config);
      continue;
    }
    const std::size_t before = watch.size();
    if (voxel.hot)
      take_in_known(watch, key, voxel, input, config);
    else if (!voxel.learned(model) && voxel.images >= static_cast<std::uint32_t>(model.hits) &&
             voxel.mean - level > static_cast<float>(model.min_change))
      take_in_new(watch, surfaces, key, voxel, input, config);
    if (watch.size() > before) fresh.push_back(key);
  }
  take_in_parts(watch, std::move(fresh), input, config);
  notice_leaving(watch, input);
  std::erase_if(watch, [&](const auto& entry) {
    const auto& [key, watched] = entry;
    if (!input.map.find(key)) return true;
    const Time last = std::max(watched.last, watched.taken_in);
    return watched.owner == 0 && (!watched.hot || to_seconds(input.sight.time - last) > config.forget_s);
  });
  return watch;
}

}  // namespace pllit
