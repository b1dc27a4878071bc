#include "pllit/map/recent_surface.hpp"

#include <algorithm>
#include <cmath>

namespace pllit {

Vector3f RecentSurface::mean_W(const Eigen::Vector3i& voxel, const Cell& cell) const {
  const Vector3d centre_W = config_.voxel_m * (voxel.cast<double>() + Vector3d::Constant(0.5));
  return centre_W.cast<float>() + cell.offset_sum_m / cell.points;
}

bool RecentSurface::counts(const Cell& cell) const {
  return cell.points > 0.0F && way_m_ - cell.way_m < config_.memory_m &&
         to_seconds(now_ - cell.last) < config_.memory_s;
}

void RecentSurface::add(std::span<const Vector3f> points_W, const Vector3d& centre_W, Time time) {
  constexpr std::size_t kSweepIn = 20;  // scans
  const double radius2_m2 = config_.radius_m * config_.radius_m;
  if (size() == 0) centre_W_ = centre_W;
  way_m_ += (centre_W - centre_W_).norm();
  centre_W_ = centre_W;
  now_ = time;
  for (const Vector3f& p_W : points_W) {
    if ((p_W.cast<double>() - centre_W).squaredNorm() > radius2_m2) continue;
    const Eigen::Vector3i voxel = voxel_of(p_W, 1.0 / config_.voxel_m);
    Cell& cell = *cells_.insert(voxel_key(voxel)).first;
    if (cell.points == 0.0F) cell = {};
    const Vector3d voxel_W = config_.voxel_m * (voxel.cast<double>() + Vector3d::Constant(0.5));
    cell.offset_sum_m += (p_W.cast<double>() - voxel_W).cast<float>();
    cell.points += 1.0F;
    cell.last = time;
    cell.way_m = way_m_;
  }
  cells_.retain_in(cells_.blocks().size() / kSweepIn + 1, [&](const Eigen::Vector3i& voxel, const Cell& cell) {
    return counts(cell) && (mean_W(voxel, cell).cast<double>() - centre_W_).squaredNorm() <= radius2_m2;
  });
}

std::vector<Vector3d> RecentSurface::carve(const Sight& sight, const SightConfig& config, const ViewFrustum& view,
                                           Parts parts) {
  std::vector<Vector3d> places_W;
  const auto carve_cell = [&](const Eigen::Vector3i& voxel, Cell& cell) {
    if (cell.last == sight.time || !counts(cell)) return;
    const Vector3d p_W = mean_W(voxel, cell).cast<double>();
    if (!is_seen_through(sight, p_W, config)) return;
    cell.points = 0.0F;
    places_W.push_back(p_W);
  };
  ++carvings_;
  for (std::size_t i = 0; i < cells_.blocks().size(); ++i) {
    Blocks::Block& block = cells_.blocks()[i];
    const std::size_t in = may_show(view, block) ? parts.view : parts.rest;
    if (in > 0 && (i + carvings_) % in == 0) block.for_each(carve_cell);
  }
  return places_W;
}

bool RecentSurface::may_show(const ViewFrustum& view, const Blocks::Block& block) const {
  const double side_m = static_cast<double>(Blocks::kSide) * config_.voxel_m, radius_m = 0.5 * std::sqrt(3.0) * side_m;
  const Vector3d corner_W = config_.voxel_m * block.corner().cast<double>();
  return !block.empty() && view.may_show(corner_W + Vector3d::Constant(0.5 * side_m), radius_m);
}

SurfacePoints RecentSurface::points(const ViewFrustum& view, const NormalAt& normal_at) {
  constexpr float kMore = 6.0F, kTimes = 2.0F;  // points: a plane may not be known yet when a surface's first ones come
  SurfacePoints points;
  const auto show = [&](const Eigen::Vector3i& voxel, Cell& cell) {
    if (!counts(cell)) return;
    const Vector3f p_W = mean_W(voxel, cell);
    if (!view.contains(p_W.cast<double>())) return;
    const bool again = cell.looked_up == 0.0F || cell.points >= std::max(kMore, kTimes * cell.looked_up);
    if (cell.normal_W.isZero() && again) {
      cell.normal_W = normal_at(p_W.cast<double>());
      cell.looked_up = cell.points;
    }
    points.points_W.push_back(p_W);
    points.normals_W.push_back(cell.normal_W);
    points.fresh.push_back(to_seconds(now_ - cell.last) < config_.fresh_s ? 1 : 0);
  };
  for (Blocks::Block& block : cells_.blocks())
    if (may_show(view, block)) block.for_each(show);
  return points;
}

}  // namespace pllit
