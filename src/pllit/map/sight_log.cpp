#include "pllit/map/sight_log.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pllit {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Cells {
  int columns, rows, cell_px;
  Cells(const Camera& camera, int cell)
      : columns((camera.width + cell - 1) / cell), rows((camera.height + cell - 1) / cell), cell_px(cell) {}
  std::size_t count() const { return static_cast<std::size_t>(columns * rows); }
  std::size_t at(int column, int row) const { return static_cast<std::size_t>(row * columns + column); }
};

struct ImagePoint {
  int column_px, row_px;
  float range_m;
};

/// A point of the scene in the image, rounded to pixels.
std::optional<ImagePoint> in_image(const Vector3d& p_C, const Camera& camera, double max_range_m) {
  const double range_m = p_C.norm();
  if (p_C.z() < 0.1 * range_m || range_m > max_range_m || range_m < 1e-3) return std::nullopt;
  const auto pixel = camera.project(p_C);
  if (!pixel || pixel->x() < 0.0 || pixel->y() < 0.0 || pixel->x() > camera.width - 1.0 ||
      pixel->y() > camera.height - 1.0)
    return std::nullopt;
  return ImagePoint{static_cast<int>(pixel->x() + 0.5), static_cast<int>(pixel->y() + 0.5),
                    static_cast<float>(range_m)};
}

}  // namespace

Sight sight_of(Time time, const SE3& T_W_C, std::span<const Vector3f> points_W, const cv::Mat& calibrated,
               const Camera& camera, const SightConfig& config) {
  const Cells cells(camera, config.cell_px);
  Sight sight{.time = time,
              .T_W_C = T_W_C,
              .range_m = std::vector<float>(cells.count(), kInfinity),
              .intensity = std::vector<float>(cells.count(), 0.0F)};
  const Matrix3d R_C_W = T_W_C.rotation().transpose();
  const Vector3d p_W_C = T_W_C.translation();
  for (const Vector3f& p_W : points_W) {
    const auto point = in_image(R_C_W * (p_W.cast<double>() - p_W_C), camera, config.max_range_m);
    if (!point) continue;
    const std::size_t cell = cells.at(point->column_px / config.cell_px, point->row_px / config.cell_px);
    if (point->range_m >= sight.range_m[cell]) continue;
    sight.range_m[cell] = point->range_m;
    if (!calibrated.empty()) sight.intensity[cell] = calibrated.at<float>(point->row_px, point->column_px);
  }
  return sight;
}

Sight sight_of(Time time, const SE3& T_W_C, std::span<const Vector3f> points_W, const Camera& camera,
               const SightConfig& config) {
  return sight_of(time, T_W_C, points_W, cv::Mat(), camera, config);
}

PointSight look_at(const Sight& sight, const Vector3d& p_W, const Camera& camera, const SightConfig& config) {
  const Cells cells(camera, config.cell_px);
  const Vector3d p_C = sight.T_W_C.rotation().transpose() * (p_W - sight.T_W_C.translation());
  const auto point = in_image(p_C, camera, config.max_range_m);
  if (!point) return {};
  const int column = point->column_px / config.cell_px, row = point->row_px / config.cell_px;
  float nearest_m = kInfinity, intensity = 0.0F;
  int measured = 0;
  for (int r = std::max(0, row - 1); r <= std::min(cells.rows - 1, row + 1); ++r)
    for (int c = std::max(0, column - 1); c <= std::min(cells.columns - 1, column + 1); ++c) {
      const std::size_t cell = cells.at(c, r);
      if (sight.range_m[cell] == kInfinity) continue;
      ++measured;
      nearest_m = std::min(nearest_m, sight.range_m[cell]);
      intensity += sight.intensity[cell];
    }
  if (measured < 3) return {};
  const float margin_m =
      static_cast<float>(config.margin_m + config.margin_share * static_cast<double>(point->range_m));
  using Kind = PointSight::Kind;
  const Kind kind = nearest_m > point->range_m + margin_m   ? Kind::free
                    : nearest_m < point->range_m - margin_m ? Kind::hidden
                                                            : Kind::surface;
  return {kind, intensity / static_cast<float>(measured)};
}

void SightLog::add(Sight sight) {
  if (!sights_.empty()) {
    const SE3 step = sights_.back().T_W_C.inverse() * sight.T_W_C;
    if (step.translation().norm() < config_.spacing_m && log_so3(step.asSO3()).norm() < config_.turn_rad) return;
  }
  sights_.push_back(std::move(sight));
  if (static_cast<int>(sights_.size()) > config_.most) sights_.pop_front();
}

SightEvidence SightLog::evidence(const Vector3d& p_W, Time before) const {
  SightEvidence evidence;
  for (const Sight& sight : sights_) {
    if (sight.time >= before) break;
    const PointSight seen = look_at(sight, p_W, camera_, config_);
    if (seen.kind == PointSight::Kind::surface) ++evidence.surface;
    if (seen.kind != PointSight::Kind::free) continue;
    ++evidence.free;
    evidence.behind += seen.behind;
  }
  if (evidence.free > 0) evidence.behind /= static_cast<float>(evidence.free);
  return evidence;
}

}  // namespace pllit
