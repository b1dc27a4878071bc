#include "pllit/map/thermal_voxel.hpp"

#include <algorithm>
#include <cmath>

namespace pllit {
namespace {

constexpr float kViewSpacing_m = 0.25F;
constexpr std::uint8_t kCalmImages = 3;

/// From now on `squares` is a mean.
void settle(ThermalVoxel& voxel) { voxel.squares /= static_cast<float>(std::max(1u, voxel.images - 1)); }

/// Welford's recursion until learned, then exponential. An image that is saturated there says but "at least so bright":
/// nothing where others said more, and what others say soon stands in the place of that.
void learn(ThermalVoxel& voxel, const VoxelSample& sample, float weight_share, bool drifting,
           const VoxelModelConfig& config) {
  constexpr float kMostly = 0.5F, kHardly = 0.1F, kBetter = 0.3F;
  const bool saturated = sample.saturated > kMostly;
  if (saturated && voxel.images > 0 && voxel.saturated < kMostly) return;
  const bool replaces_bound = !saturated && voxel.saturated > kHardly;  // what it differs by from that is no spread
  const float least_weight = replaces_bound ? kBetter : 0.0F;
  const float d = sample.intensity - voxel.mean;
  const auto approach = [&](float weight) {
    voxel.mean += weight * d;
    voxel.dip += weight * (sample.dip - voxel.dip);
    voxel.rise += weight * (sample.rise - voxel.rise);
    voxel.doubt += weight * (sample.doubt - voxel.doubt);
    voxel.saturated += weight * (sample.saturated - voxel.saturated);
  };
  if (!voxel.learned(config)) {
    ++voxel.images;
    approach(std::max(least_weight, 1.0F / static_cast<float>(voxel.images)));
    if (!replaces_bound) voxel.squares += d * (sample.intensity - voxel.mean);
    if (voxel.learned(config)) settle(voxel);
    return;
  }
  ++voxel.images;
  const float young = drifting ? 0.0F : 1.0F / static_cast<float>(voxel.images);
  const float weight = weight_share * std::max({least_weight, static_cast<float>(config.adaptation), young});
  approach(weight);
  voxel.squares = (1.0F - weight) * (voxel.squares + (replaces_bound ? 0.0F : weight * d * d));
}

void remember_change(ThermalVoxel& voxel, const VoxelSample& sample) {
  constexpr std::uint16_t kShort = 8;
  if (voxel.changes == 0) voxel.change_since = sample.time;
  voxel.changes = static_cast<std::uint16_t>(std::min<int>(voxel.changes + 1, 60000));
  const auto images = static_cast<float>(std::min(voxel.changes, kShort));
  voxel.changed_mean += (sample.intensity - voxel.changed_mean) / images;
  voxel.changed_dip += (sample.dip - voxel.changed_dip) / images;
  voxel.calm = 0;
}

void remember_calm(ThermalVoxel& voxel) {
  if (voxel.changes == 0) return;
  if (++voxel.calm < kCalmImages) return;
  voxel.changes = 0;
  voxel.changed_mean = voxel.changed_dip = 0.0F;
  voxel.calm = 0;
  voxel.hot = false;
}

void judge(ThermalVoxel& voxel, const VoxelSample& sample, const VoxelModelConfig& config) {
  const float d = sample.intensity - voxel.mean;
  const float own_sigma = voxel.sigma(config), sigma = std::hypot(std::max(own_sigma, sample.spread), sample.doubt);
  const float gate = static_cast<float>(config.gate_sigmas) * sigma;
  const float limit = std::max(gate, static_cast<float>(config.min_change));
  const bool changed = voxel.hot ? d > static_cast<float>(config.release_sigmas) * sigma : std::abs(d) > limit;
  if (changed) {
    remember_change(voxel, sample);
    if (voxel.changes >= config.hits && voxel.changed_mean - voxel.mean > limit && voxel.sure_change() > 0.0F)
      voxel.hot = true;
    return;
  }
  remember_calm(voxel);
  voxel.normal_at = sample.time;
  // Between the gate and the least change that counts it may be drift: followed, but slowly. So are poor images.
  const float trust = own_sigma * own_sigma / (sigma * sigma);
  const bool drifting = std::abs(d) > gate;
  if (voxel.changes == 0) learn(voxel, sample, (drifting ? 0.25F : 1.0F) * trust, drifting, config);
}

/// Of images that say little, nothing.
void remember_brightest(ThermalVoxel& voxel, const VoxelSample& sample, const VoxelModelConfig& config) {
  if (std::hypot(sample.doubt, sample.spread) > static_cast<float>(config.min_change)) return;
  const float both = std::min(voxel.last, sample.intensity);
  if (voxel.images > 0 && (voxel.brightest_at == Time{} || both > voxel.brightest)) {
    voxel.brightest = both;
    voxel.brightest_at = sample.time;
  }
  voxel.last = sample.intensity;
}

}  // namespace

float ThermalVoxel::variance(const VoxelModelConfig& config) const {
  return learned(config) ? squares : images > 1 ? squares / static_cast<float>(images - 1) : 0.0F;
}

float ThermalVoxel::sigma(const VoxelModelConfig& config) const {
  const float few = std::max(1.0F, static_cast<float>(config.learned_after) / static_cast<float>(std::max(1u, images)));
  const float noise = std::sqrt(few) * std::max(static_cast<float>(config.noise), std::sqrt(variance(config)));
  return std::hypot(noise, doubt, saturated * static_cast<float>(config.saturated_doubt));
}

ThermalVoxel seen(ThermalVoxel voxel, const VoxelSample& sample, const VoxelModelConfig& config) {
  if (voxel.points == 0.0F) voxel.first_seen = sample.time;
  const bool was_learned = voxel.learned(config);
  voxel.passed = voxel.passed || (voxel.images > 0 && to_seconds(sample.time - voxel.last_seen) > config.passing_s);
  if (voxel.views == 0 || (sample.viewpoint_W - voxel.last_viewpoint_W).norm() > kViewSpacing_m) {
    voxel.last_viewpoint_W = sample.viewpoint_W;
    voxel.views = static_cast<std::uint16_t>(std::min<int>(voxel.views + 1, 60000));
  }
  if (!was_learned && voxel.learned(config)) settle(voxel);
  voxel.last_seen = sample.time;
  voxel.offset_sum_m += static_cast<float>(sample.points) * sample.offset_m;
  voxel.points += static_cast<float>(sample.points);
  voxel.raw = sample.raw;
  remember_brightest(voxel, sample, config);
  if (voxel.learned(config)) {
    judge(voxel, sample, config);
  } else {
    learn(voxel, sample, 1.0F, false, config);
    voxel.normal_at = sample.time;
  }
  return voxel;
}

}  // namespace pllit
