// How one submap lies on another: coarse to fine, with what speaks for and against the result.
#pragma once

#include <string>

#include "pllit/geometry/voxel_table.hpp"
#include "pllit/loop/column_search.hpp"
#include "pllit/loop/loop_config.hpp"

namespace pllit {

struct Registration {
  SE3 T_a_b{};               ///< between level frames
  ColumnMatch columns{};     ///< of the coarse step
  double overlap = 0.0;      ///< share of the upright structure that meets the other's, after the fine step
  double matched = 0.0;      ///< share of the points that meet a plane
  double rmse_m = 0.0;       ///< of those, across their planes
  double own_rmse_m = 0.0;   ///< of a's own points across the same planes: pipes and shelves are not flat
  double information = 0.0;  ///< of the weakest direction, as a share of what it would be were every plane to face it
  Matrix6 covariance = Matrix6::Identity();  ///< (theta, p) on the right of T_a_b
};

/// Planes of a cloud's voxels, found by the points near them.
class PlaneGrid {
 public:
  struct Plane {
    Vector3f centroid = Vector3f::Zero();
    Vector3f normal = Vector3f::Zero();  ///< zero: the voxel holds no plane
  };
  /// Voxels of twice `match_m` hold a plane each.
  PlaneGrid(const std::vector<Vector3f>& points, double match_m);
  /// The plane with the nearest centroid, among the eight voxels around p, if p is within match_m of it.
  const Plane* find(const Vector3f& p) const;

 private:
  double match_m_;
  VoxelTable<Plane> planes_;
};

/// Registers b to a from motions within a window (heights and tilts from none), by upright structure and then by
/// points to planes in two grids (iterated least squares with a Cauchy loss).
Registration register_submaps(const Submap& a, const Submap& b, const SearchWindow& window,
                              const RegistrationConfig& config);

/// What speaks against two places being the same; empty: nothing.
std::string refusal(const Registration& registration, const RegistrationConfig& config);

/// The same from a guess in space, without the coarse step.
Registration refine(const Submap& a, const Submap& b, const SE3& T_a_b, const RegistrationConfig& config);

}  // namespace pllit
