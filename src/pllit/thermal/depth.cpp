#include "pllit/thermal/depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pllit/thermal/near_surface.hpp"

namespace pllit {

namespace {

using Eigen::Vector2d;
using Eigen::Vector2f;

constexpr double kRad = M_PI / 180.0;

/// Stereographic projection: the tangent of half the angle from the axis, in all directions alike, without any
/// trigonometry. direction: unit, not straight backwards.
Vector2f flattened(const Vector3f& direction) { return direction.head<2>() / (1.0F + direction.z()); }

/// What part of the plane an image covers.
Eigen::AlignedBox2f field_of(const Camera& camera, float margin) {
  Eigen::AlignedBox2f field;
  constexpr int steps = 16;
  for (int i = 0; i <= steps; ++i) {
    const double u = (camera.width - 1.0) * i / steps, v = (camera.height - 1.0) * i / steps;
    for (const Vector2d& px :
         {Vector2d(u, 0.0), Vector2d(u, camera.height - 1.0), Vector2d(0.0, v), Vector2d(camera.width - 1.0, v)})
      field.extend(flattened(camera.ray(px).cast<float>()));
  }
  return {field.min() - Vector2f::Constant(margin), field.max() + Vector2f::Constant(margin)};
}

}  // namespace

/// The points around a ray, in room that is made once.
class DepthImage::Neighbours {
 public:
  static constexpr int most = 160, least = 5;

  bool full() const { return count_ == most; }
  int count() const { return count_; }
  float nearest_range_m() const { return nearest_range_m_; }
  /// `clear2`: squared angle within which a point decides how wide the patch is.
  void add(const RaysNeighbour& neighbour, float clear2) {
    if (full()) return;
    all_[count_++] = neighbour;
    if (neighbour.angle2 <= clear2) nearest_range_m_ = std::min(nearest_range_m_, neighbour.range_m);
  }
  /// Leaves those within the angle, or the nearest few where fewer are.
  void keep_within(float angle2) {
    if (count_ <= least) return;
    const auto nearer = [](const RaysNeighbour& a, const RaysNeighbour& b) { return a.angle2 < b.angle2; };
    std::nth_element(all_.begin(), all_.begin() + least - 1, all_.begin() + count_, nearer);
    const float limit = std::max(angle2, all_[least - 1].angle2);
    const auto end = std::remove_if(all_.begin(), all_.begin() + count_,
                                    [limit](const RaysNeighbour& neighbour) { return neighbour.angle2 > limit; });
    count_ = static_cast<int>(end - all_.begin());
  }
  std::span<RaysNeighbour> by_range() {
    std::sort(all_.begin(), all_.begin() + count_,
              [](const RaysNeighbour& a, const RaysNeighbour& b) { return a.range_m < b.range_m; });
    return {all_.data(), static_cast<std::size_t>(count_)};
  }

 private:
  std::array<RaysNeighbour, most> all_;
  int count_ = 0;
  float nearest_range_m_ = 1e9F;
};

DepthImage::DepthImage(std::span<const Vector3f> points_P, const SE3& T_C_P, const Camera& camera,
                       const DepthConfig& config)
    : camera_(camera), config_(config), bin_(static_cast<float>(std::tan(0.5 * config.bin_deg * kRad))) {
  const Eigen::AlignedBox2f field = field_of(camera, static_cast<float>(std::tan(0.5 * config.reach_deg * kRad)));
  corner_ = field.min();
  const float farthest = field.min().cwiseAbs().cwiseMax(field.max().cwiseAbs()).norm();
  least_bin_rad_ = 2.0F * bin_ / (1.0F + farthest * farthest);
  columns_ = static_cast<int>(field.sizes().x() / bin_) + 1;
  rows_ = static_cast<int>(field.sizes().y() / bin_) + 1;
  bins_.assign(static_cast<std::size_t>(columns_) * rows_, -1);

  const Eigen::Matrix3f R_C_P = T_C_P.rotation().cast<float>();
  const Vector3f t_C = T_C_P.translation().cast<float>();
  const auto least = static_cast<float>(config.min_range_m), most = static_cast<float>(config.max_range_m);
  const float least_cos = 2.0F / (1.0F + farthest * farthest) - 1.0F;  // of the angle from the axis
  for (const Vector3f& p_P : points_P) {
    const Vector3f p_C = R_C_P * p_P + t_C;
    const float range_m = p_C.norm();
    if (range_m > least && range_m < most && p_C.z() >= least_cos * range_m) insert(p_C, range_m);
  }
  hide();
}

Vector2f DepthImage::bin_of(const Vector3f& direction) const { return (flattened(direction) - corner_) / bin_; }

void DepthImage::insert(const Vector3f& p_C, float range_m) {
  const Vector2f bin = bin_of(p_C / range_m);
  if (!(bin.x() >= 0.0F && bin.y() >= 0.0F)) return;
  const int column = static_cast<int>(bin.x()), row = static_cast<int>(bin.y());
  if (column >= columns_ || row >= rows_) return;
  std::int32_t& at = bins_[static_cast<std::size_t>(row) * columns_ + column];
  if (at < 0) {
    at = static_cast<std::int32_t>(points_.size());
    points_.push_back(p_C);
    ranges_.push_back(range_m);
  } else if (range_m < ranges_[at]) {
    points_[at] = p_C;
    ranges_[at] = range_m;
  }
}

/// Takes out points between nearer ones: what the camera cannot see but the LiDAR could, from elsewhere or between the
/// beams that hit the surface in front. On a slanting surface the nearer ones are all on one side. "Nearer": by a jump,
/// within the hiding angle above, below, left or right, there or one bin beside.
void DepthImage::hide() {
  constexpr float none = std::numeric_limits<float>::infinity();
  const int reach = static_cast<int>(std::lround(config_.hiding_deg / config_.bin_deg)), margin = reach + 1;
  const std::ptrdiff_t stride = columns_ + 2 * margin, size = stride * (rows_ + 2 * margin);
  const auto at = [&](int row, int column) { return (row + margin) * stride + column + margin; };
  std::vector<float> ranges(size, none), of_rows(size, none), of_columns(size, none);
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column)
      if (const std::int32_t i = bins_[static_cast<std::size_t>(row) * columns_ + column]; i >= 0)
        ranges[at(row, column)] = ranges_[i];
  for (std::ptrdiff_t i = stride; i + stride < size; ++i) {  // the nearest of three bins across
    of_rows[i] = std::min({ranges[i - stride], ranges[i], ranges[i + stride]});
    of_columns[i] = std::min({ranges[i - 1], ranges[i], ranges[i + 1]});
  }
  const auto nearest = [reach](const std::vector<float>& across, std::ptrdiff_t from, std::ptrdiff_t step) {
    float range_m = none;
    for (int far = 1; far <= reach; ++far) range_m = std::min(range_m, across[from + far * step]);
    return range_m;
  };
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const std::ptrdiff_t i = at(row, column);
      if (ranges[i] == none) continue;
      const float jump =
          std::max(static_cast<float>(config_.jump_m), static_cast<float>(config_.jump_share) * ranges[i]);
      const auto nearer = [&](const std::vector<float>& across, std::ptrdiff_t step) {
        return nearest(across, i, step) < ranges[i] - jump;
      };
      if ((nearer(of_rows, -1) && nearer(of_rows, 1)) || (nearer(of_columns, -stride) && nearer(of_columns, stride)))
        bins_[static_cast<std::size_t>(row) * columns_ + column] = -1;
    }
}

void DepthImage::collect(const Vector3f& ray, Neighbours& neighbours) const {
  const auto reach = static_cast<float>(std::sin(config_.reach_deg * kRad));
  const auto clear = static_cast<float>(config_.clear_deg * kRad);
  const Vector2f centre = bin_of(ray);
  const int column = static_cast<int>(std::floor(centre.x())), row = static_cast<int>(std::floor(centre.y()));
  const auto visit = [&](int r, int c) {
    if (r < 0 || c < 0 || r >= rows_ || c >= columns_) return;
    const std::int32_t i = bins_[static_cast<std::size_t>(r) * columns_ + c];
    if (i < 0) return;
    const float angle2 = (points_[i] / ranges_[i] - ray).squaredNorm();
    if (angle2 <= reach * reach) neighbours.add({points_[i], ranges_[i], angle2}, clear * clear);
  };
  // A patch of the surface, and what tells whether a nearer one ends close by.
  const auto wanted_angle = [&] {
    return std::max(clear, static_cast<float>(config_.patch_m) / neighbours.nearest_range_m());
  };
  for (int ring = 0; !neighbours.full(); ++ring) {
    if (ring == 0) visit(row, column);
    for (int i = -ring; i < ring; ++i) {
      visit(row - ring, column + i);
      visit(row + i, column + ring);
      visit(row + ring, column - i);
      visit(row - i, column - ring);
    }
    // What the next rings hold is at least this far from the ray.
    const float beyond = static_cast<float>(ring) * least_bin_rad_;
    const bool enough = neighbours.count() >= Neighbours::least && beyond > wanted_angle();
    if (beyond > reach || enough) break;
  }
  const float wanted = wanted_angle();
  neighbours.keep_within(wanted * wanted);
}

std::optional<FeatureDepth> DepthImage::at(const Vector2d& pixel_px) const {
  const Vector3d ray = camera_.ray(pixel_px);
  Neighbours neighbours;
  collect(ray.cast<float>(), neighbours);
  return depth_on_near_surface(ray, neighbours.by_range(), config_, 0.5 * (camera_.fx + camera_.fy));
}

std::vector<Vector3f> DepthImage::points_C() const {
  std::vector<Vector3f> seen;
  for (const std::int32_t i : bins_)
    if (i >= 0) seen.push_back(points_[i]);
  return seen;
}

std::vector<EdgePoint> points_along(const LineSegment& line, const DepthImage& depths, const Camera& camera,
                                    double line_sigma_px, double step_px) {
  std::vector<EdgePoint> points;
  const int steps = std::max(1, static_cast<int>(line.length_px() / step_px));
  const double sigma_rad = line_sigma_px / (0.5 * (camera.fx + camera.fy));
  for (int i = 0; i <= steps; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(steps);
    const Vector2d px = (line.start_px + share * (line.end_px - line.start_px)).cast<double>();
    if (const auto depth = depths.at(px))
      points.push_back({.p_C = depth->range_m * camera.ray(px),
                        .sigma_ray_m = depth->sigma_m,
                        .sigma_across_m = sigma_rad * depth->range_m});
  }
  return points;
}

}  // namespace pllit
