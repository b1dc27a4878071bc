#include "pllit/lidar/plane_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace pllit {
namespace {

/// Moments of points about a reference point.
struct Moments {
  double points = 0.0;
  Vector3d sum = Vector3d::Zero();
  Matrix3d products = Matrix3d::Zero();

  /// Adds a cell whose centre lies at `offset` from the reference.
  void add(const PlaneMap::Cell& cell, const Vector3d& offset) {
    const double n = cell.points;
    const Vector3d s = cell.sum.cast<double>();
    const auto& m = cell.products;
    Matrix3d about_centre;
    about_centre << m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5];
    products += about_centre + offset * s.transpose() + s * offset.transpose() + n * offset * offset.transpose();
    sum += s + n * offset;
    points += n;
  }
};

Eigen::Vector3i corner_at(const Vector3d& p_W, double voxel_m) {
  return voxel_of(Vector3d(p_W / voxel_m - Vector3d::Constant(0.5)), 1.0);
}

/// Calls use(cell, step) for the filled ones of the 2 x 2 x 2 voxels from `corner`, `step` counted from there.
template <typename Use>
void for_window(const VoxelTable<PlaneMap::Cell>& cells, const Eigen::Vector3i& corner, const Use& use) {
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3i step(i & 1, i >> 1 & 1, i >> 2);
    if (const PlaneMap::Cell* cell = cells.find(voxel_key(corner + step))) use(*cell, step);
  }
}

}  // namespace

double PlanePatch::height_variance_m2(const Vector3d& p_W) const {
  const Vector3d t = axes_W.transpose() * (p_W - centroid_W);
  return variances_m2[0] / points * (1.0 + t[1] * t[1] / variances_m2[1] + t[2] * t[2] / variances_m2[2]);
}

Matrix3d PlanePatch::normal_covariance() const {
  const double scale = variances_m2[0] / points;
  return scale / variances_m2[1] * axes_W.col(1) * axes_W.col(1).transpose() +
         scale / variances_m2[2] * axes_W.col(2) * axes_W.col(2).transpose();
}

PlaneMap::PlaneMap(const PlaneMapConfig& config)
    : config_(config), levels_{Level{config.voxel_m, {}}, Level{config.voxel_m * config.coarse_factor, {}}} {}

void PlaneMap::insert(const PointCloud& cloud, const SE3& T_W_I) {
  const Matrix3d R = T_W_I.rotation();
  const Vector3d t = T_W_I.translation();
  for (Level& level : levels_) {
    for (const Vector3f& point_I : cloud.points_I) {
      const Vector3d p_W = R * point_I.cast<double>() + t;
      const Eigen::Vector3i voxel = voxel_of(p_W, 1.0 / level.voxel_m);
      Cell& cell = *level.cells.insert(voxel_key(voxel)).first;
      if (cell.points >= static_cast<float>(config_.max_points)) continue;
      const Vector3f d = (p_W - (voxel.cast<double>() + Vector3d::Constant(0.5)) * level.voxel_m).cast<float>();
      cell.points += 1.0F;
      cell.sum += d;
      cell.products[0] += d.x() * d.x();
      cell.products[1] += d.x() * d.y();
      cell.products[2] += d.x() * d.z();
      cell.products[3] += d.y() * d.y();
      cell.products[4] += d.y() * d.z();
      cell.products[5] += d.z() * d.z();
    }
  }
}

void PlaneMap::slide(const Vector3d& centre_W) {
  const auto keep_within = [&](double radius_m) {
    for (Level& level : levels_)
      level.cells.retain([&](VoxelKey key, const Cell&) {
        const Vector3d p = level.voxel_m * voxel_of_key(key).cast<double>();
        return (p - centre_W).cwiseAbs().maxCoeff() < radius_m;
      });
  };
  double radius_m = config_.radius_m;
  if ((centre_W - last_centre_W_).norm() > 0.1 * radius_m) {
    keep_within(radius_m);
    last_centre_W_ = centre_W;
  }
  // The tables double when half full, so the limit holds for the size after the next doubling.
  const double cell_mb = (sizeof(VoxelKey) + sizeof(Cell)) / 1e6;
  const auto needed_mb = [&] {
    return 4.0 * cell_mb * static_cast<double>(levels_[0].cells.size() + levels_[1].cells.size());
  };
  while (needed_mb() > config_.memory_mb && radius_m > 10.0 * config_.voxel_m) keep_within(radius_m *= 0.8);
}

void PlaneMap::clear() {
  for (Level& level : levels_) level.cells.clear();
}

PlaneMap::Window PlaneMap::window_at(const Vector3d& p_W) const {
  return {voxel_key(corner_at(p_W, levels_[0].voxel_m)), voxel_key(corner_at(p_W, levels_[1].voxel_m))};
}

std::optional<PlanePatch> PlaneMap::plane_at(const Vector3d& p_W) const {
  for (const Level& level : levels_)
    if (auto plane = fit(level, corner_at(p_W, level.voxel_m))) return plane;
  return std::nullopt;
}

bool PlaneMap::knows(const Vector3d& p_W) const {
  for (const Level& level : levels_) {
    double points = 0.0;
    for_window(level.cells, corner_at(p_W, level.voxel_m),
               [&](const Cell& cell, const Eigen::Vector3i&) { points += cell.points; });
    if (points >= config_.min_points) return true;
  }
  return false;
}

std::optional<PlanePatch> PlaneMap::fit(const Level& level, const Eigen::Vector3i& corner) const {
  Moments moments;
  for_window(level.cells, corner, [&](const Cell& cell, const Eigen::Vector3i& step) {
    moments.add(cell, level.voxel_m * (step.cast<double>() - Vector3d::Constant(0.5)));
  });
  if (moments.points < config_.min_points) return std::nullopt;
  const Vector3d mean = moments.sum / moments.points;
  const Matrix3d covariance = moments.products / moments.points - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
  eigen.computeDirect(covariance);

  // Three of the points' freedoms went into the plane; an honest variance divides by what is left.
  const double thickness2 = std::max(0.0, eigen.eigenvalues()[0]) * moments.points / (moments.points - 3.0);
  const double max_thickness_m = config_.max_thickness * level.voxel_m;
  if (thickness2 > max_thickness_m * max_thickness_m) return std::nullopt;
  if (thickness2 > config_.max_flatness * eigen.eigenvalues()[1]) return std::nullopt;

  PlanePatch plane;
  plane.centroid_W = mean + level.voxel_m * (corner.cast<double>() + Vector3d::Constant(1.0));
  plane.axes_W = eigen.eigenvectors();
  plane.variances_m2 << thickness2, eigen.eigenvalues()[1], eigen.eigenvalues()[2];
  plane.points = moments.points;
  plane.voxel_m = level.voxel_m;
  return plane;
}

std::size_t PlaneMap::bytes() const { return levels_[0].cells.bytes() + levels_[1].cells.bytes(); }

}  // namespace pllit
