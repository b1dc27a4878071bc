#include "pllit/thermal/near_surface.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

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

/// A plane fitted to points, with what is known of it.
struct Plane {
  Vector3d centre = Vector3d::Zero();
  Eigen::Vector3d variances_m2 = Vector3d::Zero();  ///< ascending: about the plane, then within it
  Matrix3d axes = Matrix3d::Identity();             ///< columns: normal, then within
  int points = 0;

  Vector3d normal() const { return axes.col(0); }
};

template <class Keep>
Plane plane_through(std::span<const RaysNeighbour> points, const Keep& keep) {
  Plane plane;
  Matrix3d squares = Matrix3d::Zero();
  const Vector3d origin = points.front().p_C.cast<double>();
  for (const RaysNeighbour& point : points) {
    const Vector3d p = point.p_C.cast<double>() - origin;
    if (!keep(point)) continue;
    plane.centre += p;
    squares += p * p.transpose();
    ++plane.points;
  }
  if (plane.points == 0) return plane;
  plane.centre /= plane.points;
  Eigen::SelfAdjointEigenSolver<Matrix3d> eigen;
  eigen.computeDirect(squares / plane.points - plane.centre * plane.centre.transpose());
  plane.variances_m2 = eigen.eigenvalues().cwiseMax(0.0);
  plane.axes = eigen.eigenvectors();
  plane.centre += origin;
  return plane;
}

/// A fit without the points (mixed pixels, small things) that stand off the plane of the others.
Plane trimmed_plane(std::span<const RaysNeighbour> points, const DepthConfig& config) {
  constexpr int rounds = 4;
  const double limit = 2.0 * config.range_sigma_m;
  Plane plane = plane_through(points, [](const RaysNeighbour&) { return true; });
  for (int round = 0; round < rounds; ++round) {
    const Plane kept = plane_through(points, [&](const RaysNeighbour& point) {
      return std::abs((point.p_C.cast<double>() - plane.centre).dot(plane.normal())) <= limit;
    });
    if (kept.points < static_cast<int>(least_points) || kept.points == plane.points) break;
    plane = kept;
  }
  return plane;
}

}  // namespace

std::optional<FeatureDepth> depth_on_near_surface(const Vector3d& ray, std::span<RaysNeighbour> by_range,
                                                  const DepthConfig& config, double focal_px) {
  const auto points = owner_of(ray, by_range, config);
  if (points.size() < least_points) return std::nullopt;
  const Plane plane = trimmed_plane(points, config);
  const double range_sigma = config.range_sigma_m, middle_m = plane.centre.norm();
  if (std::sqrt(plane.variances_m2[0]) > 1.5 * range_sigma + config.residual_share * middle_m) return std::nullopt;

  const double slant = plane.normal().dot(ray);
  const double cos_incidence = std::abs(slant);
  if (cos_incidence < std::cos(config.most_incidence_deg * kRad)) return std::nullopt;
  const double range_m = plane.normal().dot(plane.centre) / slant;
  const auto [low, high] = std::ranges::minmax(points, {}, &RaysNeighbour::range_m);
  const double doubt_m = jump_m(range_m, config);
  if (!(range_m > low.range_m - doubt_m && range_m < high.range_m + doubt_m)) return std::nullopt;

  // Height of the fitted plane where the ray meets it: the mean's error and the tilt's, about both axes.
  constexpr double least_spread_m2 = 1e-6;
  const Vector3d offset = plane.axes.transpose() * (range_m * ray - plane.centre);
  const double scatter = std::max(range_sigma * range_sigma, plane.variances_m2[0]) / plane.points;
  const double height = scatter * (1.0 + offset[1] * offset[1] / std::max(plane.variances_m2[1], least_spread_m2) +
                                   offset[2] * offset[2] / std::max(plane.variances_m2[2], least_spread_m2));
  const double tan_incidence = std::sqrt(1.0 - cos_incidence * cos_incidence) / cos_incidence;
  const double bearing_m = range_m * tan_incidence * config.bearing_sigma_px / focal_px;
  // The range's own error counts whole: what a surface does to a LiDAR's beam it does to all of them.
  const double variance = range_sigma * range_sigma + height / (cos_incidence * cos_incidence) + bearing_m * bearing_m;
  if (variance > doubt_m * doubt_m) return std::nullopt;
  return FeatureDepth{.range_m = range_m,
                      .sigma_m = std::sqrt(variance),
                      .normal_C = slant > 0.0 ? Vector3d(-plane.normal()) : plane.normal()};
}

}  // namespace pllit
