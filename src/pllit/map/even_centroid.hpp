// The middle of points that lie more densely here than there.
#pragma once

#include <map>

#include "pllit/geometry/lie.hpp"
#include "pllit/geometry/voxel_table.hpp"

namespace pllit {

/// Where something is: the centroid of the cells that its points lie in, so that a part that is measured more densely
/// weighs no more.
class EvenCentroid {
 public:
  explicit EvenCentroid(double cell_m) : cell_m_(cell_m) {}

  void add(const Vector3d& p_W) {
    Cell& cell = cells_[voxel_key(voxel_of(p_W, 1.0 / cell_m_))];
    cell.sum_W += p_W;
    cell.points += 1.0;
  }
  Vector3d centroid_W() const {
    Vector3d sum = Vector3d::Zero();
    for (const auto& [key, cell] : cells_) sum += cell.sum_W / cell.points;
    return sum / static_cast<double>(cells_.size());
  }
  /// Of the centroid, from how the cells scatter.
  Matrix3d covariance_m2() const {
    const Vector3d centre_W = centroid_W();
    const auto n = static_cast<double>(cells_.size());
    Matrix3d sum = Matrix3d::Zero();
    for (const auto& [key, cell] : cells_) {
      const Vector3d d = cell.sum_W / cell.points - centre_W;
      sum += d * d.transpose();
    }
    return sum / (n * n);
  }

 private:
  struct Cell {
    Vector3d sum_W = Vector3d::Zero();
    double points = 0.0;
  };
  double cell_m_;
  std::map<VoxelKey, Cell> cells_;
};

}  // namespace pllit
