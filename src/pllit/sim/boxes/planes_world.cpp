#include "pllit/sim/boxes/planes_world.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace pllit {

using Eigen::Vector3d;

PlanesWorld::PlanesWorld(std::vector<Rectangle> rectangles)
    : rectangles_(std::move(rectangles)), all_(rectangles_.size()) {
  std::iota(all_.begin(), all_.end(), std::size_t{0});
  patches_.reserve(rectangles_.size());
  for (const Rectangle& r : rectangles_) {
    const Vector3d normal = r.half_u_W.cross(r.half_v_W).normalized();
    patches_.push_back({normal, r.center_W, r.half_u_W / r.half_u_W.squaredNorm(),
                        r.half_v_W / r.half_v_W.squaredNorm(), normal.dot(r.center_W),
                        std::hypot(r.half_u_W.norm(), r.half_v_W.norm())});
  }
}

std::vector<std::size_t> PlanesWorld::near_plane(const Vector3d& origin_W, const Vector3d& normal_W,
                                                 double slack) const {
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    const Vector3d to_center = patches_[i].center - origin_W;
    const double reach_m = patches_[i].radius + slack * (to_center.norm() + patches_[i].radius);
    if (std::abs(normal_W.dot(to_center)) <= reach_m) near.push_back(i);
  }
  return near;
}

std::optional<RayHit> PlanesWorld::cast(const Vector3d& origin_W, const Vector3d& direction_W,
                                        double max_range_m) const {
  return cast(origin_W, direction_W, max_range_m, all_);
}

std::optional<RayHit> PlanesWorld::cast(const Vector3d& origin_W, const Vector3d& direction_W, double max_range_m,
                                        std::span<const std::size_t> among) const {
  std::optional<RayHit> nearest;
  double limit_m = max_range_m;
  for (const std::size_t i : among) {
    const Patch& patch = patches_[i];
    const double approach = patch.normal.dot(direction_W);
    const double range_m = (patch.offset - patch.normal.dot(origin_W)) / approach;
    if (!(range_m > 0.0 && range_m < limit_m)) continue;  // NaN, for a ray inside the plane, is no hit either
    const Vector3d from_center = origin_W + range_m * direction_W - patch.center;
    if (std::abs(patch.u.dot(from_center)) > 1.0 || std::abs(patch.v.dot(from_center)) > 1.0) continue;
    limit_m = range_m;
    nearest = RayHit{range_m, i, std::abs(approach)};
  }
  return nearest;
}

double PlanesWorld::distance_m(const Vector3d& point_W) const {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Rectangle& r : rectangles_) {
    const Vector3d from_center = point_W - r.center_W;
    const double u = std::clamp(r.half_u_W.dot(from_center) / r.half_u_W.squaredNorm(), -1.0, 1.0);
    const double v = std::clamp(r.half_v_W.dot(from_center) / r.half_v_W.squaredNorm(), -1.0, 1.0);
    nearest_m = std::min(nearest_m, (from_center - u * r.half_u_W - v * r.half_v_W).norm());
  }
  return nearest_m;
}

}  // namespace pllit
