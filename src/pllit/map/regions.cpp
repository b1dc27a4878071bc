#include "pllit/map/regions.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <numeric>

#include "pllit/base/robust.hpp"
#include "pllit/geometry/voxel_table.hpp"

namespace pllit {
namespace {

/// Mean intensity of each voxel of a region that was seen often enough.
using RegionVoxels = std::map<VoxelKey, double>;

RegionVoxels voxels_in(const Region& region, const PointTable& table, std::string_view value,
                       const RegionsConfig& config) {
  const auto *values = find_field(table, value), *images = find_field(table, "images");
  RegionVoxels voxels;
  if (!values || !images) return voxels;
  std::map<VoxelKey, int> points;
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    if ((*images)[i] < static_cast<float>(config.images) || !region.contains(table.points[i].cast<double>())) continue;
    const VoxelKey key = voxel_key(voxel_of(table.points[i], 1.0 / config.voxel_m));
    double& mean = voxels[key];
    mean += (static_cast<double>((*values)[i]) - mean) / ++points[key];
  }
  return voxels;
}

std::optional<RegionValues> values_over(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::ranges::sort(values);
  const auto at_95 = static_cast<std::size_t>(0.95 * static_cast<double>(values.size() - 1) + 0.5);
  return RegionValues{std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()),
                      values[at_95], values.back()};
}

std::optional<bool> reached(const std::optional<double>& limit, const std::vector<double>& values, int voxels) {
  if (!limit || values.empty()) return std::nullopt;
  return std::ranges::count_if(values, [&](double value) { return value >= *limit; }) >=
         std::min<std::ptrdiff_t>(voxels, std::ssize(values));
}

using Intensity = std::function<double(double)>;

/// Temperatures as they are with the region's emissivity; any intensity as it is where the region names none.
Intensity with_emissivity_of(const Region& region, const Radiometry& radiometry) {
  if (!region.emissivity) return [](double intensity) { return intensity; };
  return [equation = RadiometricEquation(radiometry), emissivity = *region.emissivity](double object_K) {
    return equation.with_emissivity(object_K, emissivity);
  };
}

RegionReading reading_of(const Region& region, const RegionVoxels& before, const RegionVoxels& now,
                         const BringIntensity& bring, const RegionsConfig& config) {
  RegionReading reading{.baseline_voxels = static_cast<int>(before.size()), .voxels = static_cast<int>(now.size())};
  const Intensity on_baseline = with_emissivity_of(region, config.baseline_radiometry),
                  on_visit = with_emissivity_of(region, config.visit_radiometry);
  std::vector<double> own, brought, changes;
  for (const auto& [key, intensity] : now) {
    own.push_back(on_visit(intensity));
    const auto past = before.find(key);
    reading.seen_again += past != before.end() ? 1 : 0;
    const Vector3d p_W = config.voxel_m * (voxel_of_key(key).cast<double>() + Vector3d::Constant(0.5));
    const auto as_on_baseline = bring(p_W, intensity);
    if (!as_on_baseline) continue;
    brought.push_back(on_baseline(*as_on_baseline));
    if (past != before.end()) changes.push_back(brought.back() - on_baseline(past->second));
  }
  reading.kelvin_exceeded = reached(region.limits.kelvin, own, config.limit_voxels);
  reading.change_exceeded = reached(region.limits.change, changes, config.limit_voxels);
  if (const auto change = values_over(changes)) reading.change = {change->mean, change->max};
  reading.own = values_over(std::move(own));
  reading.brought = values_over(std::move(brought));
  return reading;
}

/// Adds the bytes of a value: the FNV-1a hash.
template <class T>
void add_to(std::uint64_t& digest, const T& value) {
  unsigned char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  for (const unsigned char byte : bytes) digest = (digest ^ byte) * 1099511628211ULL;
}

}  // namespace

std::vector<RegionReading> region_readings(const PointTable& baseline, const PointTable& visit,
                                           const BringIntensity& bring, std::span<const Region> regions,
                                           const RegionsConfig& config) {
  std::vector<RegionReading> readings;
  for (const Region& region : regions)
    readings.push_back(reading_of(region, voxels_in(region, baseline, "normal", config),
                                  voxels_in(region, visit, "intensity", config), bring, config));
  return readings;
}

std::vector<RegionReading> baseline_readings(const PointTable& baseline, std::span<const Region> regions,
                                             const RegionsConfig& config) {
  const BringIntensity as_it_is = [](const Vector3d&, double intensity) { return intensity; };
  std::vector<RegionReading> readings;
  for (const Region& region : regions) {
    const RegionVoxels voxels = voxels_in(region, baseline, "normal", config);
    RegionsConfig alone = config;
    alone.visit_radiometry = config.baseline_radiometry;
    readings.push_back(reading_of(region, voxels, voxels, as_it_is, alone));
  }
  return readings;
}

std::uint64_t digest_of(const PointTable& baseline) {
  std::uint64_t digest = 14695981039346656037ULL;
  for (const Vector3f& p_W : baseline.points)
    for (const float coordinate : {p_W.x(), p_W.y(), p_W.z()}) add_to(digest, coordinate);
  if (const auto* normal = find_field(baseline, "normal"))
    for (const float intensity : *normal) add_to(digest, intensity);
  return digest;
}

std::optional<RegionTrend> trend_of(std::span<const TimedValue> values) {
  constexpr double kSecondsOfDay = 86400.0, kLeastDays = 1.0 / 24.0;
  if (values.size() < 3) return std::nullopt;
  const auto [first, last] = std::ranges::minmax(values, {}, &TimedValue::time);
  std::vector<std::pair<double, double>> points;
  for (const TimedValue& value : values)
    points.emplace_back(to_seconds(value.time - first.time) / kSecondsOfDay, value.value);
  const double days = to_seconds(last.time - first.time) / kSecondsOfDay;
  const auto slope = theil_sen_slope(points);
  if (days < kLeastDays || !slope) return std::nullopt;
  return RegionTrend{*slope, static_cast<int>(values.size()), days};
}

}  // namespace pllit
