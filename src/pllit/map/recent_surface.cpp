#include "pllit/map/recent_surface.hpp"

#include <algorithm>
#include <cmath>

namespace pllit {

ViewCone view_cone(const SE3& T_W_C, const Camera& camera, double reach_m) {
  constexpr double kMargin = 0.03;
  double least_cos = 1.0;
  for (const double x : {0.0, camera.width - 1.0})
    for (const double y : {0.0, camera.height - 1.0}) least_cos = std::min(least_cos, camera.ray({x, y}).z());
  return {T_W_C.translation(), T_W_C.rotation().col(2), std::max(0.0, least_cos - kMargin), reach_m};
}

Vector3f RecentSurface::centre_W(const Block& block, const Cell& cell) const {
  const Eigen::Vector3i within(cell.place / (kSide * kSide), cell.place / kSide % kSide, cell.place % kSide);
  return (config_.voxel_m * ((block.corner + within).cast<double>() + Vector3d::Constant(0.5))).cast<float>();
}

bool RecentSurface::counts(const Block& block, const Cell& cell) const {
  return cell.points > 0.0F && way_m_ - cell.way_m < config_.memory_m &&
         to_seconds(now_ - cell.last) < config_.memory_s &&
         (mean_W(block, cell).cast<double>() - centre_W_).squaredNorm() < config_.radius_m * config_.radius_m;
}

RecentSurface::Cell& RecentSurface::cell_at(const Eigen::Vector3i& voxel) {
  const auto block_at = [](int i) { return i >= 0 ? i / kSide : (i + 1) / kSide - 1; };
  const Eigen::Vector3i at = voxel.unaryExpr(block_at), within = voxel - kSide * at;
  std::uint32_t& number = *block_of_.insert(voxel_key(at)).first;
  if (number == 0) {
    if (spare_.empty()) {
      blocks_.emplace_back();
      spare_.push_back(static_cast<std::uint32_t>(blocks_.size()));
    }
    number = spare_.back();
    spare_.pop_back();
    blocks_[number - 1].corner = kSide * at;
  }
  Block& block = blocks_[number - 1];
  const auto place = static_cast<std::uint16_t>((within.x() * kSide + within.y()) * kSide + within.z());
  std::uint16_t& cell = block.cell_of[place];
  if (cell == 0) {
    block.cells.push_back({.place = place});
    cell = static_cast<std::uint16_t>(block.cells.size());
    ++size_;
  }
  return block.cells[cell - 1U];
}

void RecentSurface::sweep(Block& block) {
  const std::size_t erased = std::erase_if(block.cells, [&](const Cell& cell) { return !counts(block, cell); });
  if (erased == 0) return;
  size_ -= erased;
  block.cell_of.fill(0);
  for (std::size_t i = 0; i < block.cells.size(); ++i)
    block.cell_of[block.cells[i].place] = static_cast<std::uint16_t>(i + 1);
}

void RecentSurface::add(std::span<const Vector3f> points_W, const Vector3d& centre_W, Time time) {
  if (size_ == 0) centre_W_ = centre_W;
  way_m_ += (centre_W - centre_W_).norm();
  centre_W_ = centre_W;
  now_ = time;
  for (const Vector3f& p_W : points_W) {
    if ((p_W.cast<double>() - centre_W).squaredNorm() > config_.radius_m * config_.radius_m) continue;
    const Eigen::Vector3i voxel = voxel_of(p_W, 1.0 / config_.voxel_m);
    Cell& cell = cell_at(voxel);
    if (cell.points == 0.0F) cell = {.place = cell.place};
    const Vector3d voxel_W = config_.voxel_m * (voxel.cast<double>() + Vector3d::Constant(0.5));
    cell.offset_sum_m += (p_W.cast<double>() - voxel_W).cast<float>();
    cell.points += 1.0F;
    cell.last = time;
    cell.way_m = way_m_;
  }
  constexpr std::size_t kSweepIn = 20;  // scans
  swept_to_ = block_of_.retain_some(swept_to_, block_of_.slots() / kSweepIn + 1, [&](VoxelKey, std::uint32_t number) {
    sweep(blocks_[number - 1]);
    const bool is_empty = blocks_[number - 1].cells.empty();
    if (is_empty) spare_.push_back(number);
    return !is_empty;
  });
}

std::vector<Vector3d> RecentSurface::carve(const Sight& sight, const SightConfig& config, std::size_t parts) {
  std::vector<Vector3d> places_W;
  for (std::size_t left = (blocks_.size() + parts - 1) / parts; left > 0; --left) {
    if (carved_to_ >= blocks_.size()) carved_to_ = 0;
    Block& block = blocks_[carved_to_++];
    for (Cell& cell : block.cells) {
      if (cell.last == sight.time || !counts(block, cell)) continue;
      const Vector3d p_W = mean_W(block, cell).cast<double>();
      if (!is_seen_through(sight, p_W, config)) continue;
      cell.points = 0.0F;
      places_W.push_back(p_W);
    }
  }
  return places_W;
}

SurfacePoints RecentSurface::points(const ViewCone& view, const NormalAt& normal_at) {
  constexpr float kMore = 6.0F, kTimes = 2.0F;  // points: a plane may not be known yet when a surface's first ones come
  const double side_m = kSide * config_.voxel_m, radius_m = 0.5 * std::sqrt(3.0) * side_m;
  SurfacePoints points;
  for (Block& block : blocks_) {
    if (block.cells.empty()) continue;
    const Vector3d middle_W = config_.voxel_m * block.corner.cast<double>() + Vector3d::Constant(0.5 * side_m);
    if (!view.may_show(middle_W, radius_m)) continue;
    for (Cell& cell : block.cells) {
      if (!counts(block, cell)) continue;
      const Vector3f p_W = mean_W(block, cell);
      if (!view.contains(p_W.cast<double>())) continue;
      const bool again = cell.looked_up == 0.0F || cell.points >= std::max(kMore, kTimes * cell.looked_up);
      if (cell.normal_W.isZero() && again) {
        cell.normal_W = normal_at(p_W.cast<double>());
        cell.looked_up = cell.points;
      }
      points.points_W.push_back(p_W);
      points.normals_W.push_back(cell.normal_W);
      points.fresh.push_back(to_seconds(now_ - cell.last) < config_.fresh_s ? 1 : 0);
    }
  }
  return points;
}

}  // namespace pllit
