#include "pllit/map/hot_parts.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <unordered_set>

#include "pllit/geometry/voxel_neighbours.hpp"

namespace pllit {
namespace {

/// What a watched voxel shows now.
float intensity_of(const WatchedVoxel& watched, const ThermalVoxel& voxel) {
  if (watched.new_surface) return voxel.present();
  return watched.joined ? voxel.last : voxel.changed_mean;
}

/// Whether a voxel has no cool past beside a hot one: it came into sight with that or later.
bool came_with(const ThermalVoxel& voxel, const WatchedVoxel& hot, const VoxelModelConfig& model,
               const WatchConfig& config) {
  if (config.whole_things) return voxel.first_seen >= hot.cool - from_seconds(config.part_lead_s);
  return !voxel.learned(model) && voxel.images >= static_cast<std::uint32_t>(model.hits);
}

/// What is known of an anomaly, or of all that belongs to none yet.
struct Thing {
  float heat = 0.0F;  ///< mean change of the voxels that were judged by themselves
  int seeds = 0, parts = 0;
};
using Things = std::map<std::uint32_t, Thing>;  ///< by the anomaly's number; 0: none yet

Things things_of(const Watch& watch) {
  Things things;
  for (const auto& [key, watched] : watch) {
    if (!watched.hot) continue;
    Thing& thing = things[watched.owner];
    ++(watched.joined ? thing.parts : thing.seeds);
    if (!watched.joined) thing.heat += watched.change;
  }
  for (auto& [owner, thing] : things) thing.heat /= static_cast<float>(std::max(1, thing.seeds));
  return things;
}

/// What the parts of a thing are measured by: what it began with and has become, not the voxel beside them, for halving
/// from voxel to voxel ends nowhere.
float heat_of(const WatchedVoxel& hot, const Thing& thing) {
  const float begun_with = hot.seed_change > 0.0F ? hot.seed_change : hot.change;
  return hot.owner == 0 ? begun_with : std::max(begun_with, thing.heat);
}

/// A voxel as a part of a hot one next to it, if it is one.
std::optional<WatchedVoxel> part_of(const WatchedVoxel& hot, float heat, VoxelKey key, const ThermalVoxel& voxel,
                                    const ThermalMap& map, const WatchConfig& config) {
  const VoxelModelConfig& model = map.config().model;
  const float least = std::max(part_change(model, config), 0.5F * heat);
  WatchedVoxel part{.joined = true,
                    .cool = hot.cool,
                    .seed_change = heat,
                    .owner = hot.owner,
                    .position_W = map.position_W(key, voxel)};
  part.hits = std::max(static_cast<int>(voxel.images), model.hits) - 1;
  if (config.whole_things && voxel.learned(model)) {
    const float sigma = voxel.sigma(model);
    const bool still = voxel.last_seen >= hot.since - from_seconds(config.part_lead_s);
    if (still && voxel.last - voxel.mean > std::max(least, static_cast<float>(model.gate_sigmas) * sigma)) {
      part.since = voxel.last_seen;
      part.normal = voxel.mean;
      part.sigma = sigma;
      return part;
    }
  }
  if (voxel.mean - hot.normal < least || !came_with(voxel, hot, model, config)) return std::nullopt;
  part.new_surface = true;
  part.since = voxel.first_seen;
  part.normal = hot.normal;
  part.sigma = hot.sigma;
  return part;
}

/// No more parts than twice what a thing's own voxels vouch for: what would grow further is seen to be none by then.
bool take_in(Watch& watch, Things& things, const WatchedVoxel& hot, VoxelKey key, const ThermalVoxel& voxel,
             const WatchInput& input, const WatchConfig& config) {
  Thing& thing = things[hot.owner];
  if (config.whole_things && thing.parts >= 2 * config.parts_of_one * std::max(1, thing.seeds)) return false;
  auto part = part_of(hot, heat_of(hot, thing), key, voxel, input.map, config);
  if (!part) return false;
  ++thing.parts;
  part->taken_in = input.sight.time;
  note_heat(*part, voxel);
  watch.emplace(key, *part);
  return true;
}

/// The lowest normal of what is hot now.
float coolest_normal(const Watch& watch) {
  float coolest = std::numeric_limits<float>::infinity();
  for (const auto& [key, watched] : watch)
    if (watched.hot) coolest = std::min(coolest, watched.normal);
  return coolest;
}

/// A quick look before neighbours are searched for: whether it could be a part of anything.
bool may_be_part(const ThermalVoxel& voxel, float coolest, float least, const WatchConfig& config) {
  return voxel.mean - coolest >= least || (config.whole_things && voxel.last - voxel.mean > least);
}

/// Blocks of voxels that hold something hot, so that most voxels need not look around themselves.
class HotBlocks {
 public:
  explicit HotBlocks(const Watch& watch) {
    for (const auto& [key, watched] : watch)
      if (watched.hot) add(key);
  }
  void add(VoxelKey key) { blocks_.insert(voxel_key(block_of(voxel_of_key(key)))); }
  /// Whether a block within so many voxels does.
  bool near(VoxelKey key, int reach) const {
    const Eigen::Vector3i voxel = voxel_of_key(key), low = block_of(voxel.array() - reach),
                          high = block_of(voxel.array() + reach);
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y)
        for (int x = low.x(); x <= high.x(); ++x)
          if (blocks_.contains(voxel_key({x, y, z}))) return true;
    return false;
  }

 private:
  static Eigen::Vector3i block_of(const Eigen::Vector3i& voxel) {
    constexpr int kSideBits = 2;
    return voxel.unaryExpr([](int i) { return i >> kSideBits; });
  }

  std::unordered_set<VoxelKey> blocks_;
};

bool take_in_beside_hot(Watch& watch, Things& things, VoxelKey key, const WatchInput& input,
                        const WatchConfig& config) {
  const ThermalVoxel& voxel = *input.map.find(key);
  bool taken = false;
  for_neighbours(key, config.part_voxels, [&](VoxelKey next) {
    const auto found = taken ? watch.end() : watch.find(next);
    if (found == watch.end() || !found->second.hot) return;
    const WatchedVoxel hot = found->second;
    taken = take_in(watch, things, hot, key, voxel, input, config);
  });
  return taken;
}

}  // namespace

void note_heat(WatchedVoxel& watched, const ThermalVoxel& voxel) {
  watched.change = intensity_of(watched, voxel) - watched.normal;
  watched.peak = std::max(watched.peak, watched.change);
  watched.sure =
      std::max(watched.sure, watched.new_surface ? voxel.sure_change_from(watched.normal) : voxel.sure_change());
  watched.last = watched.seen = voxel.last_seen;
  watched.hot = true;
  ++watched.hits;
}

void take_in_parts(Watch& watch, std::vector<VoxelKey> fresh, const WatchInput& input, const WatchConfig& config) {
  if (watch.empty()) return;
  const float least = part_change(input.map.config().model, config);
  float coolest = coolest_normal(watch);
  Things things = things_of(watch);
  HotBlocks hot_blocks(watch);
  for (const VoxelKey key : input.seen) {
    if (!hot_blocks.near(key, config.part_voxels) || watch.contains(key)) continue;
    if (!may_be_part(*input.map.find(key), coolest, least, config)) continue;
    if (!take_in_beside_hot(watch, things, key, input, config)) continue;
    hot_blocks.add(key);
    coolest = std::min(coolest, watch.at(key).normal);
    fresh.push_back(key);
  }
  if (!config.whole_things) return;
  while (!fresh.empty()) {
    const VoxelKey key = fresh.back();
    fresh.pop_back();
    const WatchedVoxel hot = watch.at(key);
    for_neighbours(key, config.part_voxels, [&](VoxelKey next) {
      const ThermalVoxel* voxel = watch.contains(next) ? nullptr : input.map.find(next);
      if (voxel && voxel->images > 0 && take_in(watch, things, hot, next, *voxel, input, config)) fresh.push_back(next);
    });
  }
}

}  // namespace pllit
