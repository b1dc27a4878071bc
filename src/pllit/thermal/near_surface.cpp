#include "pllit/thermal/near_surface.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace pllit {

namespace {

using Eigen::Vector2f;

constexpr double kRad = M_PI / 180.0;
constexpr std::size_t least_points = 5;

double jump_m(double range_m, const DepthConfig& config) {
  return std::max(config.jump_m, config.jump_share * range_m);
}

/// Points that no jump of range parts from each other.
struct Surface {
  std::span<RaysNeighbour> points;
  double angle = 0.0;   ///< of the nearest point from the ray, rad
  bool around = false;  ///< the nearest points lie all around the ray
};

/// Whether points lie on every side of the ray, so that it passes through their midst.
bool all_around(const Vector3d& ray, std::span<const RaysNeighbour> points) {
  constexpr std::size_t most = 8;
  const std::size_t count = std::min(most, points.size());
  const Vector3f u = ray.unitOrthogonal().cast<float>(), v = ray.cast<float>().cross(u);
  std::array<Vector2f, most> sides;
  for (std::size_t i = 0; i < count; ++i) sides[i] = {points[i].p_C.dot(u), points[i].p_C.dot(v)};
  for (std::size_t i = 0; i < count; ++i) {
    const auto left_of_i = [&](const Vector2f& other) {
      return sides[i].x() * other.y() - sides[i].y() * other.x() >= 0.0F;
    };
    if (std::all_of(sides.begin(), sides.begin() + count, left_of_i)) return false;
  }
  return true;
}

Surface surface_of(const Vector3d& ray, std::span<RaysNeighbour> points) {
  constexpr std::size_t looked_at = 8;
  const auto middle = points.begin() + std::min(looked_at, points.size());
  std::partial_sort(points.begin(), middle, points.end(),
                    [](const RaysNeighbour& a, const RaysNeighbour& b) { return a.angle2 < b.angle2; });
  return {.points = points,
          .angle = std::sqrt(static_cast<double>(points.front().angle2)),
          .around = all_around(ray, points)};
}

/// The nearest points up to the first jump of range; the rest is left in `points`.
std::span<RaysNeighbour> split_nearest(std::span<RaysNeighbour>& points, const DepthConfig& config) {
  std::size_t end = 1;
  while (end < points.size() && points[end].range_m - points[end - 1].range_m < jump_m(points[end].range_m, config))
    ++end;
  const auto nearest = points.first(end);
  points = points.subspan(end);
  return nearest;
}

/// The surface that owns the ray (see the header); empty where that is open. What lies behind a nearer surface's edge
/// is not to be told from the edge itself by beams as wide as the gap, and the edge is what images show.
std::span<RaysNeighbour> owner_of(const Vector3d& ray, std::span<RaysNeighbour> points, const DepthConfig& config) {
  while (!points.empty()) {
    const Surface surface = surface_of(ray, split_nearest(points, config));
    const bool few = surface.points.size() < least_points;
    if (!few && (surface.around || surface.angle < config.edge_deg * kRad)) return surface.points;
    if (surface.angle < config.clear_deg * kRad) return {};
  }
  return {};
}

/// A plane seen around a ray. Its inverse depth is linear in where one looks, and what errs is the depth alone: at a
/// few metres the noise along the rays is as large as the patch, and a total least squares fit would take the one for
/// the other. In metres: y = z0^2 / z over the offset x = z0 (u, v) across the ray, z along it; z0 is about where it
/// lies.
struct RayPlane {
  Vector3d coefficients = Vector3d::Zero();  ///< y on the ray, and its slopes
  Matrix3d covariance = Matrix3d::Zero();
  double scatter_m2 = 0.0;
  std::size_t points = 0;
};

class RayPlaneFit {
 public:
  RayPlaneFit(const Vector3d& ray, std::span<const RaysNeighbour> points, double range_sigma_m)
      : ray_(ray), u_(ray.unitOrthogonal()), v_(ray.cross(u_)), points_(points), sigma_m_(range_sigma_m) {
    z0_m_ = points[points.size() / 2].p_C.cast<double>().dot(ray);
    assert(points.size() <= rows_.size());
    std::ranges::transform(points, rows_.begin(), [this](const RaysNeighbour& point) { return row(point); });
  }

  /// The fit to the points within `limit_m` of `before`.
  RayPlane fit(const RayPlane& before, double limit_m) const {
    // Slopes are taken to be a few at most, which decides where the points lie on a line or too close together.
    constexpr double slope_sigma = 2.0;
    const double ridge = sigma_m_ * sigma_m_ / (slope_sigma * slope_sigma);
    Matrix3d XtX = Vector3d(0.0, ridge, ridge).asDiagonal();
    Vector3d Xty = Vector3d::Zero();
    double yy = 0.0;
    RayPlane plane;
    for (const auto& [x, y] : std::span(rows_).first(points_.size())) {
      if (std::abs(y - x.dot(before.coefficients)) > limit_m) continue;
      XtX += x * x.transpose();
      Xty += y * x;
      yy += y * y;
      ++plane.points;
    }
    if (plane.points < least_points) return plane;
    const Matrix3d inverse = XtX.inverse();
    plane.coefficients = inverse * Xty;
    const double freedom = std::max(1.0, static_cast<double>(plane.points) - 3.0);
    plane.scatter_m2 = std::max(0.0, yy - plane.coefficients.dot(Xty)) / freedom;
    plane.covariance = std::max(plane.scatter_m2, sigma_m_ * sigma_m_) * inverse;
    return plane;
  }

  /// Without the points (mixed pixels, small things) that stand off the plane of the others.
  RayPlane trimmed() const {
    constexpr int rounds = 4;
    RayPlane plane = fit({}, std::numeric_limits<double>::infinity());
    for (int round = 0; round < rounds; ++round) {
      const RayPlane kept = fit(plane, 2.5 * std::max(sigma_m_, std::min(std::sqrt(plane.scatter_m2), 2.0 * sigma_m_)));
      if (kept.points < least_points || kept.points == plane.points) break;
      plane = kept;
    }
    return plane;
  }

  double range_m(const RayPlane& plane) const { return z0_m_ * z0_m_ / plane.coefficients[0]; }
  double tan_incidence(const RayPlane& plane) const {
    return plane.coefficients.tail<2>().norm() * z0_m_ / plane.coefficients[0];
  }
  /// Unit, towards the camera.
  Vector3d normal(const RayPlane& plane) const {
    const Vector3d& c = plane.coefficients;
    return -(c[0] / z0_m_ * ray_ + c[1] * u_ + c[2] * v_).normalized();
  }

 private:
  struct Row {
    Vector3d x;
    double y;
  };
  Row row(const RaysNeighbour& point) const {
    const Vector3d p = point.p_C.cast<double>();
    const double scale = z0_m_ / p.dot(ray_);
    return {{1.0, scale * p.dot(u_), scale * p.dot(v_)}, z0_m_ * scale};
  }

  Vector3d ray_, u_, v_;
  std::span<const RaysNeighbour> points_;
  double sigma_m_, z0_m_;
  std::array<Row, kMostNeighbours> rows_;
};

}  // namespace

std::optional<FeatureDepth> depth_on_near_surface(const Vector3d& ray, std::span<RaysNeighbour> by_range,
                                                  const DepthConfig& config, double focal_px) {
  const auto points = owner_of(ray, by_range, config);
  if (points.size() < least_points) return std::nullopt;
  const RayPlaneFit fit(ray, points, config.range_sigma_m);
  const RayPlane plane = fit.trimmed();
  if (plane.points < least_points || !(plane.coefficients[0] > 0.0)) return std::nullopt;
  const double range_m = fit.range_m(plane), tan_incidence = fit.tan_incidence(plane);
  if (std::sqrt(plane.scatter_m2) > 1.5 * config.range_sigma_m + config.residual_share * range_m) return std::nullopt;
  if (tan_incidence > std::tan(config.most_incidence_deg * kRad)) return std::nullopt;
  const auto [low, high] = std::ranges::minmax(points, {}, &RaysNeighbour::range_m);
  const double doubt_m = jump_m(range_m, config);
  if (!(range_m > low.range_m - doubt_m && range_m < high.range_m + doubt_m)) return std::nullopt;

  const double bearing_m = range_m * tan_incidence * config.bearing_sigma_px / focal_px;
  // The range's own error counts whole: what a surface does to a LiDAR's beam it does to all of them.
  const double variance = config.range_sigma_m * config.range_sigma_m + plane.covariance(0, 0) + bearing_m * bearing_m;
  if (variance > doubt_m * doubt_m) return std::nullopt;
  return FeatureDepth{.range_m = range_m, .sigma_m = std::sqrt(variance), .normal_C = fit.normal(plane)};
}

}  // namespace pllit
