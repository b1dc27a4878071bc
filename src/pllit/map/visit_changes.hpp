// What differs between two visits' thermographic maps, hours or days apart.
#pragma once

#include <string_view>
#include <vector>

#include "pllit/map/seen_space.hpp"
#include "pllit/map/visit_drift.hpp"
#include "pllit/state/table.hpp"

namespace pllit {

enum class VisitChangeKind {
  hotter,
  cooler,
  new_hot,  ///< a surface where the first visit looked through, hotter than what stands around it
  gone      ///< a surface of the first visit, looked through now
};
std::string_view name_of(VisitChangeKind kind);

struct VisitChangesConfig {
  double voxel_m = 0.1;      ///< maps of two visits lie on each other to a few centimetres
  int images = 6;            ///< of a surface on each visit, at least
  double min_change = 30.0;  ///< in the map's unit
  double gate_sigmas = 3.0;  ///< of the surface's spread and of the drift's fit
  int min_voxels = 4;        ///< smaller clusters are noise ...
  int new_points = 5;        ///< ... but of what is new, two voxels will do with so many of the map's points in them
  /// Means of a voxel's points on the two visits that lie farther apart are of different surfaces.
  double same_place_m = 0.05;
  double looked_through = 0.6;    ///< share of the voxels of what is new, or gone, that the other visit looked through
  int gone_voxels = 8;            ///< what is smaller and gone is not worth a word
  double saturated_doubt = 60.0;  ///< what a wholly saturated voxel's sigma contains; see VoxelModelConfig
  double surround_m = 0.8;        ///< how far around a new surface its surroundings are looked at
  /// Share of one visit's surfaces, as its LiDAR measured them, that must be the other's too: rooms of one building
  /// style fit onto each other here and there, but what one visit saw of a site, another sees again.
  double least_shared = 0.8;
  VisitDriftConfig drift{};
};

/// A cluster of changed voxels; changes in the unit of the first map, signed, and zero of what is gone.
struct VisitChange {
  VisitChangeKind kind = VisitChangeKind::hotter;
  Vector3d position_W = Vector3d::Zero();
  Vector3d extent_m = Vector3d::Zero();
  int voxels = 0;
  double mean = 0.0, peak = 0.0, mean_sigmas = 0.0;
};

struct VisitChanges {
  VisitDrift drift;                               ///< where it does not hold, nothing is judged
  int shared = 0, only_before = 0, only_now = 0;  ///< voxels
  double surfaces_shared = 0.0;                   ///< of the visit of which more is the other's too, see least_shared
  bool same_site = false;                         ///< enough of them
  std::vector<VisitChange> changes{};             ///< greatest first
};

/// A visit's map as ThermalMap::table gives it, and the sightlines of its LiDAR, in one world for both visits.
struct VisitHeat {
  PointTable heat{};
  std::vector<Sightline> sightlines_W{};
};

/// Compares two visits. A surface counts as new only where the first one's LiDAR measured none and looked through: what
/// nobody had looked at before may have been hot for ever.
VisitChanges changes_between(const VisitHeat& before, const VisitHeat& now, const VisitChangesConfig& config = {});

}  // namespace pllit
