// The surfaces around the rig that the LiDAR has lately measured from nearly here: what it saw from elsewhere the
// camera may not see, and what hides it may not have been measured yet.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/geometry/voxel_blocks.hpp"
#include "pllit/map/image_sampling.hpp"
#include "pllit/map/sight_log.hpp"
#include "pllit/map/view_frustum.hpp"

namespace pllit {

struct RecentSurfaceConfig {
  double voxel_m = 0.05;   ///< one point is kept in each
  double radius_m = 12.0;  ///< around the rig
  double memory_m = 2.0;   ///< what was not measured on the last so many metres of way is forgotten
  double memory_s = 20.0;  ///< nor for so long
  double fresh_s = 0.3;    ///< what was measured so lately is called fresh
};

/// Unit normal of the surface at a point in W; zero where unknown.
using NormalAt = std::function<Vector3f(const Vector3d& p_W)>;

class RecentSurface {
 public:
  explicit RecentSurface(const RecentSurfaceConfig& config) : config_(config) {}

  /// Takes in a scan, in W; forgets what is old or far.
  void add(std::span<const Vector3f> points_W, const Vector3d& centre_W, Time time);
  /// Takes out what a sight of the last scans alone sees through, and returns where that was: in each call one part of
  /// what a view may show, and one of the rest, of so many parts, in turn; 0: none.
  struct Parts {
    std::size_t view = 1, rest = 1;
  };
  std::vector<Vector3d> carve(const Sight& sight, const SightConfig& config, const ViewFrustum& view, Parts parts);
  /// One point a voxel, the mean of those measured, in a view. A voxel's normal is looked up when it is first in view,
  /// and until it is known again whenever twice as many points have come.
  SurfacePoints points(const ViewFrustum& view, const NormalAt& normal_at);
  std::size_t size() const { return cells_.size(); }
  std::size_t bytes() const { return cells_.bytes(); }

 private:
  struct Cell {
    Vector3f offset_sum_m = Vector3f::Zero();  ///< from the voxel's centre
    float points = 0.0F;                       ///< 0: seen through, waits to be swept out
    Vector3f normal_W = Vector3f::Zero();
    float looked_up = 0.0F;  ///< the normal, when there were so many points
    Time last{};
    double way_m = 0.0;  ///< of the rig, when last measured
  };
  using Blocks = VoxelBlocks<Cell>;

  Vector3f mean_W(const Eigen::Vector3i& voxel, const Cell& cell) const;
  /// Neither seen through, nor old.
  bool counts(const Cell& cell) const;
  bool may_show(const ViewFrustum& view, const Blocks::Block& block) const;

  RecentSurfaceConfig config_;
  Blocks cells_;
  std::size_t carvings_ = 0;
  Vector3d centre_W_ = Vector3d::Zero();
  double way_m_ = 0.0;
  Time now_{};
};

}  // namespace pllit
