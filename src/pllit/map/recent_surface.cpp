#include "pllit/map/recent_surface.hpp"

#include <algorithm>

namespace pllit {

ViewCone view_cone(const SE3& T_W_C, const Camera& camera) {
  constexpr double kMargin = 0.03;
  double least_cos = 1.0;
  for (const double x : {0.0, camera.width - 1.0})
    for (const double y : {0.0, camera.height - 1.0}) least_cos = std::min(least_cos, camera.ray({x, y}).z());
  return {T_W_C.translation(), T_W_C.rotation().col(2), std::max(0.0, least_cos - kMargin)};
}

Vector3f RecentSurface::mean_W(VoxelKey key, const Cell& cell) const {
  const Vector3f centre_W =
      (config_.voxel_m * (voxel_of_key(key).cast<double>() + Vector3d::Constant(0.5))).cast<float>();
  return centre_W + cell.offset_sum_m / cell.points;
}

bool RecentSurface::counts(VoxelKey key, const Cell& cell) const {
  return cell.points > 0.0F && way_m_ - cell.way_m < config_.memory_m &&
         to_seconds(now_ - cell.last) < config_.memory_s &&
         (mean_W(key, cell).cast<double>() - centre_W_).squaredNorm() < config_.radius_m * config_.radius_m;
}

void RecentSurface::add(std::span<const Vector3f> points_W, const Vector3d& centre_W, Time time,
                        const NormalAt& normal_at) {
  if (!cells_.size()) centre_W_ = centre_W;
  way_m_ += (centre_W - centre_W_).norm();
  centre_W_ = centre_W;
  now_ = time;
  constexpr float kLook = 6.0F;  // a surface's plane may not be known yet when its first points come
  for (const Vector3f& p_W : points_W) {
    if ((p_W.cast<double>() - centre_W).squaredNorm() > config_.radius_m * config_.radius_m) continue;
    const Eigen::Vector3i voxel = voxel_of(p_W, 1.0 / config_.voxel_m);
    Cell& cell = *cells_.insert(voxel_key(voxel)).first;
    if (cell.points == 0.0F) cell = {};
    const Vector3d voxel_W = config_.voxel_m * (voxel.cast<double>() + Vector3d::Constant(0.5));
    cell.offset_sum_m += (p_W.cast<double>() - voxel_W).cast<float>();
    cell.points += 1.0F;
    cell.last = time;
    cell.way_m = way_m_;
    if (cell.points == 1.0F || (cell.points == kLook && cell.normal_W.isZero()))
      cell.normal_W = normal_at(p_W.cast<double>());
  }
  constexpr std::size_t kSweepIn = 20;  // scans
  swept_to_ = cells_.retain_some(swept_to_, cells_.slots() / kSweepIn + 1,
                                 [&](VoxelKey key, const Cell& cell) { return counts(key, cell); });
}

std::vector<Vector3d> RecentSurface::carve(const Sight& sight, const SightConfig& config) {
  std::vector<VoxelKey> left;
  std::vector<Vector3d> places_W;
  cells_.for_each([&](VoxelKey key, const Cell& cell) {
    if (cell.last == sight.time || !counts(key, cell)) return;
    const Vector3d p_W = mean_W(key, cell).cast<double>();
    if (look_around(sight, p_W, config) != PointSight::free) return;
    left.push_back(key);
    places_W.push_back(p_W);
  });
  for (const VoxelKey key : left) cells_.insert(key).first->points = 0.0F;
  return places_W;
}

SurfacePoints RecentSurface::points(const ViewCone& view) const {
  SurfacePoints points;
  cells_.for_each([&](VoxelKey key, const Cell& cell) {
    if (!counts(key, cell)) return;
    const Vector3f p_W = mean_W(key, cell);
    if (!view.contains(p_W.cast<double>())) return;
    points.points_W.push_back(p_W);
    points.normals_W.push_back(cell.normal_W);
  });
  return points;
}

}  // namespace pllit
