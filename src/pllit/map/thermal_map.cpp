#include "pllit/map/thermal_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace pllit {
namespace {

/// Mean over the observations of one voxel.
VoxelSample sample_of(const ThermalView& view, const Vector3d& centre_W,
                      std::span<const std::pair<VoxelKey, std::size_t>> members) {
  VoxelSample sample{.time = view.time,
                     .viewpoint_W = view.viewpoint_W.cast<float>(),
                     .offset_m = Vector3f::Zero(),
                     .spread = static_cast<float>(view.spread),
                     .points = static_cast<int>(members.size())};
  for (const auto& [key, index] : members) {
    const SurfaceObservation& observation = view.observations[index];
    sample.intensity += observation.intensity;
    sample.raw += observation.raw;
    sample.dip += observation.dip;
    sample.rise += observation.rise;
    sample.doubt += observation.doubt;
    sample.saturated += observation.saturated ? 1.0F : 0.0F;
    sample.offset_m += (observation.p_W - centre_W).cast<float>();
  }
  const float share = 1.0F / static_cast<float>(members.size());
  sample.intensity *= share;
  sample.raw *= share;
  sample.dip *= share;
  sample.rise *= share;
  sample.doubt *= share;
  sample.saturated *= share;
  sample.offset_m *= share;
  return sample;
}

}  // namespace

std::vector<VoxelKey> ThermalMap::integrate(const ThermalView& view) {
  if (!start_) start_ = view.time;
  std::vector<std::pair<VoxelKey, std::size_t>> order;
  order.reserve(view.observations.size());
  for (std::size_t i = 0; i < view.observations.size(); ++i) order.emplace_back(key_at(view.observations[i].p_W), i);
  std::ranges::sort(order);
  std::vector<VoxelKey> seen_keys;
  for (auto begin = order.begin(); begin != order.end();) {
    const VoxelKey key = begin->first;
    const auto end = std::find_if(begin, order.end(), [key](const auto& entry) { return entry.first != key; });
    ThermalVoxel& voxel = *voxels_.insert(key).first;
    voxel = seen(voxel, sample_of(view, centre_W(key), {begin, end}), config_.model);
    seen_keys.push_back(key);
    begin = end;
  }
  return seen_keys;
}

void ThermalMap::forget(const Vector3d& p_W) {
  const VoxelKey key = key_at(p_W);
  if (voxels_.find(key)) *voxels_.insert(key).first = {};
}

PointTable ThermalMap::trim() {
  PointTable dropped;
  for (const std::string& name : fields()) dropped.fields.push_back({name, {}});
  if (static_cast<double>(bytes()) <= config_.memory_mb * 1e6) return dropped;
  std::vector<Time> times;
  voxels_.for_each([&](const Eigen::Vector3i&, const ThermalVoxel& voxel) { times.push_back(voxel.last_seen); });
  const auto oldest_kept = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 4);
  std::ranges::nth_element(times, oldest_kept);
  const Time limit = *oldest_kept;
  voxels_.retain([&](const Eigen::Vector3i& at, const ThermalVoxel& voxel) {
    if (voxel.last_seen > limit) return true;
    if (voxel.points > 0.0F) append(dropped, at, voxel, *start_);
    return false;
  });
  return dropped;
}

Vector3d ThermalMap::centre_W(VoxelKey key) const {
  return config_.voxel_m * (voxel_of_key(key).cast<double>() + Vector3d::Constant(0.5));
}

Vector3d ThermalMap::position_W(VoxelKey key, const ThermalVoxel& voxel) const {
  return centre_W(key) + (voxel.offset_sum_m / std::max(1.0F, voxel.points)).cast<double>();
}

std::vector<std::string> ThermalMap::fields() {
  return {"intensity", "normal", "sigma", "raw", "images", "views", "change_sigmas", "seen_s", "saturated"};
}

void ThermalMap::append(PointTable& table, const Eigen::Vector3i& at, const ThermalVoxel& voxel, Time start) const {
  table.points.push_back(position_W(voxel_key(at), voxel).cast<float>());
  const float sigma = voxel.sigma(config_.model);
  const std::array<float, 9> values{voxel.present(),
                                    voxel.mean,
                                    sigma,
                                    voxel.raw,
                                    static_cast<float>(voxel.images),
                                    static_cast<float>(voxel.views),
                                    (voxel.present() - voxel.mean) / sigma,
                                    static_cast<float>(to_seconds(voxel.last_seen - start)),
                                    voxel.saturated};
  for (std::size_t i = 0; i < values.size(); ++i) table.fields[i].values.push_back(values[i]);
}

PointTable ThermalMap::table() const {
  PointTable table;
  for (const std::string& name : fields()) table.fields.push_back({name, {}});
  voxels_.for_each([&](const Eigen::Vector3i& at, const ThermalVoxel& voxel) {
    if (voxel.points > 0.0F) append(table, at, voxel, *start_);
  });
  return table;
}

}  // namespace pllit
