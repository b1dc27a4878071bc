#include "pllit/map/visit_changes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "pllit/geometry/voxel_neighbours.hpp"
#include "pllit/map/surroundings.hpp"

namespace pllit {
namespace {

/// What a visit knows of a voxel: means over the points of its table that were seen often enough.
struct Known {
  Vector3d sum_W = Vector3d::Zero();
  double value = 0.0, variance = 0.0, variance_below = 0.0;
  int points = 0;

  Vector3d mean_W() const { return sum_W / points; }
  double mean() const { return value / points; }
  double mean_variance() const { return variance / points; }
  /// Without what saturation adds: the surface may be brighter than it showed, not darker.
  double mean_variance_below() const { return variance_below / points; }
};
using Voxels = std::map<VoxelKey, Known>;

Voxels voxels_of(const PointTable& table, std::string_view value, const VisitChangesConfig& config) {
  const auto *values = find_field(table, value), *images = find_field(table, "images"),
             *sigmas = find_field(table, "sigma"), *saturated = find_field(table, "saturated");
  Voxels voxels;
  if (!values || !images || !sigmas) return voxels;
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    if ((*images)[i] < static_cast<float>(config.images)) continue;
    Known& known = voxels[voxel_key(voxel_of(table.points[i], 1.0 / config.voxel_m))];
    known.sum_W += table.points[i].cast<double>();
    known.value += static_cast<double>((*values)[i]);
    const double variance = std::pow(static_cast<double>((*sigmas)[i]), 2);
    const double doubt = saturated ? config.saturated_doubt * static_cast<double>((*saturated)[i]) : 0.0;
    known.variance += variance;
    known.variance_below += std::max(0.0, variance - doubt * doubt);
    ++known.points;
  }
  return voxels;
}

VisitDrift drift_between(const Voxels& before, const Voxels& now, const VisitChangesConfig& config) {
  std::vector<SharedVoxel> shared;
  for (const auto& [key, seen] : now)
    if (const auto found = before.find(key); found != before.end())
      shared.push_back({.p_W = seen.mean_W(),
                        .before = found->second.mean(),
                        .now = seen.mean(),
                        .sigma_before = std::sqrt(found->second.mean_variance()),
                        .sigma_now = std::sqrt(seen.mean_variance())});
  return {shared, config.drift};
}

struct Changed {
  VisitChangeKind kind;
  Vector3d p_W;
  double change, sigmas;
  int points = 1;
};

/// Changes of surfaces that both visits saw, by at least the gate. At seams one of two neighbouring voxels may hold
/// what the other held: a change that a neighbour's past explains is none.
void add_known(const Voxels& before, const Voxels& now, const VisitDrift& drift, const VisitChangesConfig& config,
               std::map<VoxelKey, Changed>& changed) {
  for (const auto& [key, seen] : now) {
    const auto past = before.find(key);
    if (past == before.end() || (past->second.mean_W() - seen.mean_W()).norm() > config.same_place_m) continue;
    const auto brought = drift.bring(seen.mean_W(), seen.mean());
    if (!brought) continue;
    const double value = brought->value, change = value - past->second.mean();
    const double variance = change > 0.0 ? past->second.mean_variance() + seen.mean_variance_below()
                                         : past->second.mean_variance_below() + seen.mean_variance();
    const double sigma = std::hypot(std::sqrt(variance), brought->sigma);
    if (std::abs(change) < std::max(config.min_change, config.gate_sigmas * sigma)) continue;
    bool explained = false;
    for_neighbours(key, 1, [&](VoxelKey next) {
      const auto other = before.find(next);
      explained = explained || (next != key && other != before.end() && (value - other->second.mean()) / change < 0.5);
    });
    if (explained) continue;
    changed.emplace(key, Changed{change > 0.0 ? VisitChangeKind::hotter : VisitChangeKind::cooler, seen.mean_W(),
                                 change, change / sigma});
  }
}

/// A new surface against those around it that the first visit's LiDAR knew: as the second visit sees both, for the
/// first one's camera may have looked elsewhere.
std::optional<Changed> heat_of_new(const Voxels& now, VoxelKey key, const Known& seen, const SeenSpace& space_before,
                                   const VisitChangesConfig& config) {
  const int reach = std::max(1, static_cast<int>(config.surround_m / config.voxel_m));
  std::vector<double> around;
  for_neighbours(key, reach, [&](VoxelKey next) {
    const auto other = now.find(next);
    if (other != now.end() && space_before.surface_at(next)) around.push_back(other->second.mean());
  });
  const auto surroundings = surroundings_of(std::move(around));
  if (!surroundings) return std::nullopt;
  const double change = seen.mean() - surroundings->upper;
  const double sigma = std::hypot(surroundings->spread, std::sqrt(seen.mean_variance_below()));
  if (change <= std::max(config.min_change, config.gate_sigmas * sigma)) return std::nullopt;
  return Changed{VisitChangeKind::new_hot, seen.mean_W(), change, change / sigma, seen.points};
}

/// Surfaces where the first visit's LiDAR knew none, hotter than what stands around; and what is new as well, next to
/// them and half as hot: a large thing's middle has nothing around it, and a side of it may stand next to a hot one.
void add_new(const Voxels& now, const SeenSpace& space_before, const VisitChangesConfig& config,
             std::map<VoxelKey, Changed>& changed) {
  struct Part {
    VoxelKey key;
    double normal, sigma, least;  ///< of the one that was judged by itself, from which it was reached
  };
  std::vector<Part> parts;
  for (const auto& [key, seen] : now) {
    if (space_before.surface_at(key)) continue;
    const auto heat = heat_of_new(now, key, seen, space_before, config);
    if (!heat) continue;
    changed.emplace(key, *heat);
    parts.push_back({.key = key,
                     .normal = seen.mean() - heat->change,
                     .sigma = heat->change / heat->sigmas,
                     .least = std::max(config.min_change, 0.5 * heat->change)});
  }
  while (!parts.empty()) {
    const Part part = parts.back();
    parts.pop_back();
    for_neighbours(part.key, 1, [&](VoxelKey next) {
      const auto seen = now.find(next);
      if (seen == now.end() || changed.contains(next) || space_before.surface_at(next)) return;
      const double change = seen->second.mean() - part.normal;
      if (change < part.least) return;
      changed.emplace(next, Changed{VisitChangeKind::new_hot, seen->second.mean_W(), change, change / part.sigma,
                                    seen->second.points});
      parts.push_back(part);
      parts.back().key = next;
    });
  }
}

void add_gone(const Voxels& before, const Voxels& now, const SeenSpace& space_now,
              std::map<VoxelKey, Changed>& changed) {
  for (const auto& [key, past] : before)
    if (!now.contains(key) && !space_now.surface_at(key))
      changed.emplace(key, Changed{VisitChangeKind::gone, past.mean_W(), 0.0, 0.0});
}

/// Whether a cluster is large enough.
bool fills(const std::vector<Changed>& cluster, const VisitChangesConfig& config) {
  const auto voxels = static_cast<int>(cluster.size());
  if (cluster.front().kind == VisitChangeKind::gone) return voxels >= config.gone_voxels;
  if (cluster.front().kind != VisitChangeKind::new_hot) return voxels >= config.min_voxels;
  int points = 0;
  for (const Changed& one : cluster) points += one.points;
  return voxels >= 2 && points >= config.new_points;
}

/// Whether a cluster is to be told. Of what a visit's sightlines only brush past at the edges, it says nothing.
bool counts(const std::vector<Changed>& cluster, const SeenSpace& space_before, const SeenSpace& space_now,
            const VisitChangesConfig& config) {
  const VisitChangeKind kind = cluster.front().kind;
  if (!fills(cluster, config)) return false;
  if (kind != VisitChangeKind::new_hot && kind != VisitChangeKind::gone) return true;
  const SeenSpace& other = kind == VisitChangeKind::gone ? space_now : space_before;
  const auto through = std::ranges::count_if(cluster, [&](const Changed& one) {
    return other.looked_through(voxel_key(voxel_of(one.p_W, 1.0 / config.voxel_m)));
  });
  return static_cast<double>(through) >= config.looked_through * static_cast<double>(cluster.size());
}

VisitChange summed(const std::vector<Changed>& cluster) {
  VisitChange change{.kind = cluster.front().kind, .voxels = static_cast<int>(cluster.size())};
  Eigen::AlignedBox3d box_W;
  for (const Changed& one : cluster) {
    box_W.extend(one.p_W);
    change.position_W += one.p_W / double(cluster.size());
    change.mean += one.change / double(cluster.size());
    change.mean_sigmas += one.sigmas / double(cluster.size());
    if (std::abs(one.change) > std::abs(change.peak)) change.peak = one.change;
  }
  change.extent_m = box_W.sizes();
  return change;
}

/// Changed voxels of one kind that hang together, the greatest first.
std::vector<VisitChange> clusters(std::map<VoxelKey, Changed> changed, const SeenSpace& space_before,
                                  const SeenSpace& space_now, const VisitChangesConfig& config) {
  const auto same_kind = [](const Changed& a, const Changed& b) { return a.kind == b.kind; };
  std::vector<VisitChange> found;
  for (const auto& cluster : connected(std::move(changed), same_kind))
    if (counts(cluster, space_before, space_now, config)) found.push_back(summed(cluster));
  std::ranges::stable_sort(found, std::greater{}, [](const VisitChange& c) { return std::abs(c.mean_sigmas); });
  return found;
}

}  // namespace

std::string_view name_of(VisitChangeKind kind) {
  switch (kind) {
    case VisitChangeKind::hotter:
      return "hotter";
    case VisitChangeKind::cooler:
      return "cooler";
    case VisitChangeKind::new_hot:
      return "new_hot";
    case VisitChangeKind::gone:
      break;
  }
  return "gone";
}

VisitChanges changes_between(const VisitHeat& before, const VisitHeat& now, const VisitChangesConfig& config) {
  const Voxels past = voxels_of(before.heat, "normal", config), present = voxels_of(now.heat, "intensity", config);
  VisitChanges result{.drift = drift_between(past, present, config)};
  for (const auto& [key, known] : present) ++(past.contains(key) ? result.shared : result.only_now);
  result.only_before = static_cast<int>(past.size()) - result.shared;
  const SeenSpace space_before(before.sightlines_W, {.voxel_m = config.voxel_m}),
      space_now(now.sightlines_W, {.voxel_m = config.voxel_m});
  result.surfaces_shared = std::max(space_before.share_in(space_now), space_now.share_in(space_before));
  result.same_site = result.surfaces_shared >= config.least_shared;
  if (!result.same_site) return result;
  std::map<VoxelKey, Changed> changed;
  add_known(past, present, result.drift, config, changed);
  add_new(present, space_before, config, changed);
  add_gone(past, present, space_now, changed);
  result.changes = clusters(std::move(changed), space_before, space_now, config);
  return result;
}

}  // namespace pllit
