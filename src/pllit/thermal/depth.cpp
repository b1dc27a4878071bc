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

constexpr float kNone = std::numeric_limits<float>::infinity();

/// Stereographic projection: the tangent of half the angle from the axis, in all directions alike, without any
/// trigonometry. range: the norm of `p`, which does not point straight backwards.
Vector2f flattened(const Vector3f& p, float range) { return p.head<2>() / (range + p.z()); }

/// What part of the plane an image covers.
Eigen::AlignedBox2f field_of(const Camera& camera, float margin) {
  Eigen::AlignedBox2f field;
  constexpr int steps = 16;
  for (int i = 0; i <= steps; ++i) {
    const double u = (camera.width - 1.0) * i / steps, v = (camera.height - 1.0) * i / steps;
    for (const Vector2d& px :
         {Vector2d(u, 0.0), Vector2d(u, camera.height - 1.0), Vector2d(0.0, v), Vector2d(camera.width - 1.0, v)})
      field.extend(flattened(camera.ray(px).cast<float>(), 1.0F));
  }
  return {field.min() - Vector2f::Constant(margin), field.max() + Vector2f::Constant(margin)};
}

}  // namespace

/// The points around a ray, in room that is made once.
class DepthImage::Neighbours {
 public:
  static constexpr int most = kMostNeighbours, least = 5;

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
    : DepthImage(std::span(&points_P, 1), T_C_P, camera, config) {}

DepthImage::DepthImage(std::span<const std::span<const Vector3f>> scans_P, const SE3& T_C_P, const Camera& camera,
                       const DepthConfig& config)
    : camera_(camera), config_(config), bin_(static_cast<float>(std::tan(0.5 * config.bin_deg * kRad))) {
  const Eigen::AlignedBox2f field = field_of(camera, static_cast<float>(std::tan(0.5 * config.reach_deg * kRad)));
  corner_ = field.min();
  const float farthest = field.min().cwiseAbs().cwiseMax(field.max().cwiseAbs()).norm();
  least_bin_rad_ = 2.0F * bin_ / (1.0F + farthest * farthest);
  least_cos_ = 2.0F / (1.0F + farthest * farthest) - 1.0F;
  const Eigen::Array2i bins = (field.sizes() / bin_).cast<int>().array() + 1;
  ranges_m_ = Bins<float>::Constant(bins.y(), bins.x(), kNone);
  index_.resize(bins.y(), bins.x());
  for (const auto points_P : scans_P) insert(points_P, T_C_P);
  hide();
}

Vector2f DepthImage::bin_of(const Vector3f& p_C, float range_m) const {
  return (flattened(p_C, range_m) - corner_) / bin_;
}

void DepthImage::insert(std::span<const Vector3f> points_P, const SE3& T_C_P) {
  const Eigen::Matrix3f R_C_P = T_C_P.rotation().cast<float>();
  const Vector3f t_C = T_C_P.translation().cast<float>();
  const auto least = static_cast<float>(config_.min_range_m), most = static_cast<float>(config_.max_range_m);
  for (const Vector3f& p_P : points_P) {
    const Vector3f p_C = R_C_P * p_P + t_C;
    const float range_m = p_C.norm();
    if (!(range_m > least && range_m < most && p_C.z() >= least_cos_ * range_m)) continue;
    const Vector2f bin = bin_of(p_C, range_m);
    if (!(bin.x() >= 0.0F && bin.y() >= 0.0F)) continue;
    const int column = static_cast<int>(bin.x()), row = static_cast<int>(bin.y());
    if (column >= ranges_m_.cols() || row >= ranges_m_.rows()) continue;
    float& nearest_m = ranges_m_(row, column);
    if (range_m >= nearest_m) continue;
    std::int32_t& index = index_(row, column);
    if (nearest_m == kNone) {
      index = static_cast<std::int32_t>(points_.size());
      points_.push_back(p_C);
    } else {
      points_[static_cast<std::size_t>(index)] = p_C;
    }
    nearest_m = range_m;
  }
}

/// Takes out points between nearer ones: what the camera cannot see but the LiDAR could, from elsewhere or between the
/// beams that hit the surface in front. On a slanting surface the nearer ones are all on one side. "Nearer": by a jump,
/// within the hiding angle above, below, left or right, there or one bin beside.
void DepthImage::hide() {
  const int reach = static_cast<int>(std::lround(config_.hiding_deg / config_.bin_deg)), margin = reach + 1;
  const Eigen::Index rows = ranges_m_.rows(), columns = ranges_m_.cols();
  Bins<float> ranges = Bins<float>::Constant(rows + 2 * margin, columns + 2 * margin, kNone);
  ranges.block(margin, margin, rows, columns) = ranges_m_;
  Bins<float> across = ranges;  // the nearest of three bins beside each other
  across.middleCols(1, across.cols() - 2) = ranges.leftCols(ranges.cols() - 2)
                                                .min(ranges.middleCols(1, ranges.cols() - 2))
                                                .min(ranges.rightCols(ranges.cols() - 2));
  Eigen::Array<float, 1, Eigen::Dynamic> above_each_other(ranges.cols()), left(columns), right(columns), up(columns),
      down(columns);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const Eigen::Index at = row + margin;
    above_each_other = ranges.row(at - 1).min(ranges.row(at)).min(ranges.row(at + 1));
    left = right = up = down = kNone;
    for (int far = 1; far <= reach; ++far) {
      left = left.min(above_each_other.segment(margin - far, columns));
      right = right.min(above_each_other.segment(margin + far, columns));
      up = up.min(across.row(at - far).segment(margin, columns));
      down = down.min(across.row(at + far).segment(margin, columns));
    }
    auto seen = ranges_m_.row(row);
    const auto jump = (static_cast<float>(config_.jump_share) * seen).max(static_cast<float>(config_.jump_m));
    seen = (left.max(right).min(up.max(down)) < seen - jump).select(kNone, seen).eval();
  }
}

void DepthImage::collect(const Vector3f& ray, Neighbours& neighbours) const {
  const auto reach = static_cast<float>(std::sin(config_.reach_deg * kRad));
  const auto clear = static_cast<float>(config_.clear_deg * kRad);
  const Vector2f centre = bin_of(ray, 1.0F);
  const int column = static_cast<int>(std::floor(centre.x())), row = static_cast<int>(std::floor(centre.y()));
  const auto visit = [&](int r, int c) {
    if (r < 0 || c < 0 || r >= ranges_m_.rows() || c >= ranges_m_.cols() || ranges_m_(r, c) == kNone) return;
    const Vector3f& p_C = points_[static_cast<std::size_t>(index_(r, c))];
    const float range_m = ranges_m_(r, c), angle2 = (p_C / range_m - ray).squaredNorm();
    if (angle2 <= reach * reach) neighbours.add({p_C, range_m, angle2}, clear * clear);
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
  for (Eigen::Index row = 0; row < ranges_m_.rows(); ++row)
    for (Eigen::Index column = 0; column < ranges_m_.cols(); ++column)
      if (ranges_m_(row, column) != kNone) seen.push_back(points_[static_cast<std::size_t>(index_(row, column))]);
  return seen;
}

std::vector<EdgePoint> points_along(const LineSegment& line, const DepthImage& depths, const Camera& camera,
                                    double line_sigma_px, double step_px) {
  std::vector<EdgePoint> points;
  const int steps = std::max(1, static_cast<int>(line.length_px() / step_px));
  const double sigma_rad = line_sigma_px / (0.5 * (camera.fx + camera.fy));
  const Vector2d along = (line.end_px - line.start_px).cast<double>().normalized();
  const Vector2d aside_px = line_sigma_px * Vector2d(-along.y(), along.x());
  for (int i = 0; i <= steps; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(steps);
    const Vector2d px = (line.start_px + share * (line.end_px - line.start_px)).cast<double>();
    const auto depth = depths.at(px);
    if (!depth) continue;
    const Vector3d p_C = depth->range_m * camera.ray(px), beside = camera.ray(px + aside_px);
    points.push_back({.p_C = p_C,
                      .sigma_ray_m = depth->sigma_m,
                      .sigma_across_m = sigma_rad * depth->range_m,
                      .slide_C_m = p_C.dot(depth->normal_C) / beside.dot(depth->normal_C) * beside - p_C});
  }
  return points;
}

}  // namespace pllit
