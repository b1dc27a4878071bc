// The surface that an image feature lies on, from the LiDAR points around its ray.
#pragma once

#include <optional>
#include <span>

#include "pllit/thermal/depth.hpp"

namespace pllit {

constexpr int kMostNeighbours = 160;

struct RaysNeighbour {
  Vector3f p_C;
  float range_m, angle2;  ///< squared angle from the ray (chord on the unit sphere)
};

/// Range of a unit ray to the plane of the nearest surface that owns it. `by_range`: the points around it by ascending
/// range, at most kMostNeighbours; they are reordered. Surfaces are told apart by jumps of range; the nearest one that
/// lies around the ray, or ends within edge_deg of it, is it. Nothing where a nearer one ends within clear_deg, or
/// where the plane does not pass DepthConfig's checks. `focal_px`: for the share of the feature's own error.
std::optional<FeatureDepth> depth_on_near_surface(const Vector3d& ray, std::span<RaysNeighbour> by_range,
                                                  const DepthConfig& config, double focal_px);

}  // namespace pllit
