// The surfaces around the rig that the LiDAR has lately measured from nearly here: what it saw from elsewhere the
// camera may not see, and what hides it may not have been measured yet.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
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
  double fresh_s = 0.3;    ///< what was measured so lately is called fresh
};

/// Holds everything that an image may show as far as `reach_m`, and somewhat more.
struct ViewCone {
  Vector3d apex_W, axis_W;
  double least_cos = 0.0;  ///< of the angle from the axis
  double reach_m = std::numeric_limits<double>::infinity();

  bool contains(const Vector3d& p_W) const {
    const Vector3d ray_W = p_W - apex_W;
    const double range_m = ray_W.norm();
    return range_m <= reach_m && ray_W.dot(axis_W) > least_cos * range_m;
  }
  /// Whether it holds any point of a ball; true as well for some balls next to it.
  bool may_show(const Vector3d& middle_W, double radius_m) const {
    const Vector3d ray_W = middle_W - apex_W;
    const double along_m = ray_W.dot(axis_W), across_m = (ray_W - along_m * axis_W).norm();
    const double sine = std::sqrt(1.0 - least_cos * least_cos);
    return ray_W.norm() < reach_m + radius_m &&
           across_m * least_cos - along_m * sine < radius_m;  // distance from the cone's side
  }
};
ViewCone view_cone(const SE3& T_W_C, const Camera& camera, double reach_m);

/// Unit normal of the surface at a point in W; zero where unknown.
using NormalAt = std::function<Vector3f(const Vector3d& p_W)>;

class RecentSurface {
 public:
  explicit RecentSurface(const RecentSurfaceConfig& config) : config_(config) {}

  /// Takes in a scan, in W; forgets what is old or far.
  void add(std::span<const Vector3f> points_W, const Vector3d& centre_W, Time time);
  /// Takes out what a sight of the last scans alone sees through, and returns where that was. Each call looks at one
  /// part of so many, in turn.
  std::vector<Vector3d> carve(const Sight& sight, const SightConfig& config, std::size_t parts);
  /// One point a voxel, the mean of those measured, in a view. A voxel's normal is looked up when it is first in view,
  /// and until it is known again whenever twice as many points have come.
  SurfacePoints points(const ViewCone& view, const NormalAt& normal_at);
  std::size_t size() const { return size_; }
  /// Of memory, but for the cells.
  std::size_t bytes() const { return block_of_.bytes() + blocks_.capacity() * sizeof(Block); }

 private:
  /// Voxels that lie together: what an image cannot show is passed over by whole blocks.
  static constexpr int kSide = 8, kVoxels = kSide * kSide * kSide;
  struct Cell {
    Vector3f offset_sum_m = Vector3f::Zero();  ///< from the voxel's centre
    float points = 0.0F;                       ///< 0: seen through, waits to be swept out
    Vector3f normal_W = Vector3f::Zero();
    float looked_up = 0.0F;   ///< the normal, when there were so many points
    std::uint16_t place = 0;  ///< in its block
    Time last{};
    double way_m = 0.0;  ///< of the rig, when last measured
  };
  struct Block {
    Eigen::Vector3i corner = Eigen::Vector3i::Zero();  ///< its first voxel
    std::array<std::uint16_t, kVoxels> cell_of{};      ///< 1 + number of the cell at a place, 0: none
    std::vector<Cell> cells{};
  };

  Cell& cell_at(const Eigen::Vector3i& voxel);
  Vector3f centre_W(const Block& block, const Cell& cell) const;
  Vector3f mean_W(const Block& block, const Cell& cell) const {
    return centre_W(block, cell) + cell.offset_sum_m / cell.points;
  }
  /// Neither seen through, nor old, nor far.
  bool counts(const Block& block, const Cell& cell) const;
  void sweep(Block& block);

  RecentSurfaceConfig config_;
  VoxelTable<std::uint32_t> block_of_;  ///< 1 + number of the block
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> spare_;  ///< numbers of blocks that hold nothing any more
  std::size_t size_ = 0;
  std::size_t swept_to_ = 0;   ///< slot of the table
  std::size_t carved_to_ = 0;  ///< block
  Vector3d centre_W_ = Vector3d::Zero();
  double way_m_ = 0.0;
  Time now_{};
};

}  // namespace pllit
