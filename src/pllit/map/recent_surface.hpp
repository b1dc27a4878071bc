// The surfaces around the rig that the LiDAR has lately measured from nearly here: what it saw from elsewhere the
// camera may not see, and what hides it may not have been measured yet.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/geometry/voxel_table.hpp"
#include "pllit/map/image_sampling.hpp"
#include "pllit/map/sight_log.hpp"

namespace pllit {

struct RecentSurfaceConfig {
  double voxel_m = 0.05;   ///< one point is kept in each
  double radius_m = 12.0;  ///< around the rig
  double memory_m = 2.0;   ///< what was not measured on the last so many metres of way is forgotten
  double memory_s = 20.0;  ///< nor for so long
};

/// Holds everything that an image may show, and somewhat more.
struct ViewCone {
  Vector3d apex_W, axis_W;
  double least_cos = 0.0;  ///< of the angle from the axis

  bool contains(const Vector3d& p_W) const {
    const Vector3d ray_W = p_W - apex_W;
    return ray_W.dot(axis_W) > least_cos * ray_W.norm();
  }
};
ViewCone view_cone(const SE3& T_W_C, const Camera& camera);

/// Unit normal of the surface at a point in W; zero where unknown.
using NormalAt = std::function<Vector3f(const Vector3d& p_W)>;

class RecentSurface {
 public:
  explicit RecentSurface(const RecentSurfaceConfig& config) : config_(config) {}

  /// Takes in a scan, in W; forgets what is old or far.
  void add(std::span<const Vector3f> points_W, const Vector3d& centre_W, Time time, const NormalAt& normal_at);
  /// Takes out what a sight of the last scans alone sees through, and returns where that was.
  std::vector<Vector3d> carve(const Sight& sight, const SightConfig& config);
  /// One point a voxel, the mean of those measured, in a view.
  SurfacePoints points(const ViewCone& view) const;
  std::size_t size() const { return cells_.size(); }

 private:
  struct Cell {
    Vector3f offset_sum_m = Vector3f::Zero();  ///< from the voxel's centre
    float points = 0.0F;                       ///< 0: seen through, waits to be swept out
    Vector3f normal_W = Vector3f::Zero();
    Time last{};
    double way_m = 0.0;  ///< of the rig, when last measured
  };
  Vector3f mean_W(VoxelKey key, const Cell& cell) const;
  /// Neither seen through, nor old, nor far.
  bool counts(VoxelKey key, const Cell& cell) const;

  RecentSurfaceConfig config_;
  VoxelTable<Cell> cells_;
  std::size_t swept_to_ = 0;  ///< slot of the table
  Vector3d centre_W_ = Vector3d::Zero();
  double way_m_ = 0.0;
  Time now_{};
};

}  // namespace pllit
