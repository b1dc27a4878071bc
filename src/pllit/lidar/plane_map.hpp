// The map that scans are matched to: sums of points in hashed voxels, from which planes with covariance are fitted
// where they are asked for.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pllit/geometry/voxel_table.hpp"
#include "pllit/lidar/deskew.hpp"

namespace pllit {

struct PlaneMapConfig {
  double voxel_m = 0.4;         ///< a plane is fitted to the points of 2 x 2 x 2 voxels
  double coarse_factor = 3.0;   ///< a second, coarser grid serves where the fine one has too few points
  double radius_m = 100.0;      ///< what is farther from the robot than this (in any axis) is dropped
  double memory_mb = 512.0;     ///< above this the radius shrinks
  int min_points = 8;           ///< fewer points make no plane
  int max_points = 100;         ///< a voxel with this many points is complete
  double max_thickness = 0.12;  ///< standard deviation across a plane, as a share of the voxel
  double max_flatness = 0.15;   ///< variance across a plane, as a share of the smaller one along it
};

/// A plane fitted to points: variances along its axes tell how well it is known.
struct PlanePatch {
  Vector3d centroid_W;
  Matrix3d axes_W;        ///< columns: normal, then the two directions in the plane
  Vector3d variances_m2;  ///< of the points along the axes, ascending
  double points = 0.0;
  double voxel_m = 0.0;  ///< of the grid that it comes from

  Vector3d normal_W() const { return axes_W.col(0); }
  double distance_m(const Vector3d& p_W) const { return normal_W().dot(p_W - centroid_W); }
  /// Variance of the plane's height at p_W: that of a regression plane (centroid and tilt) fitted to `points` points.
  double height_variance_m2(const Vector3d& p_W) const;
  /// Covariance of the normal, 3 x 3, in W.
  Matrix3d normal_covariance() const;
};

class PlaneMap {
 public:
  explicit PlaneMap(const PlaneMapConfig& config);

  /// Adds points, moved to W by T_W_I.
  void insert(const PointCloud& cloud, const SE3& T_W_I);
  /// Drops what is far from the robot; keeps within the memory limit.
  void slide(const Vector3d& centre_W);
  void clear();

  /// The voxels that a point's plane is fitted to; two points with the same window get the same plane.
  struct Window {
    std::array<VoxelKey, 2> corners;  ///< lower corner on the fine and on the coarse grid
    bool operator==(const Window&) const = default;
  };
  Window window_at(const Vector3d& p_W) const;
  /// The plane around a point, from the fine grid or else the coarse one; nothing where there is none.
  std::optional<PlanePatch> plane_at(const Vector3d& p_W) const;
  /// Whether as many points as make a plane lie around p_W, on either grid, flat or not.
  bool knows(const Vector3d& p_W) const;

  std::size_t bytes() const;
  std::size_t voxels() const { return levels_[0].cells.size(); }
  const PlaneMapConfig& config() const { return config_; }

  /// Number, sum and products of a voxel's points, relative to its centre.
  struct Cell {
    float points = 0.0F;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    std::array<float, 6> products{};  ///< xx xy xz yy yz zz
  };

 private:
  struct Level {
    double voxel_m;
    VoxelTable<Cell> cells;
  };
  std::optional<PlanePatch> fit(const Level& level, const Eigen::Vector3i& corner) const;

  PlaneMapConfig config_;
  std::array<Level, 2> levels_;
  Vector3d last_centre_W_ = Vector3d::Zero();
};

}  // namespace pllit
