// What a visit saw through: the way of light of every point that its map holds.
#pragma once

#include <span>

#include "pllit/geometry/lie.hpp"

namespace pllit {

/// From where the LiDAR was to what it measured, in W.
struct Sightline {
  Vector3f from_W, to_W;
};

/// Whether the line passes within `radius_m` of a point and ends at least `beyond_m` behind it.
inline bool passes(const Sightline& line, const Vector3f& p_W, float radius_m, float beyond_m) {
  const Vector3f way_m = line.to_W - line.from_W, to_point_m = p_W - line.from_W;
  const float length_m = way_m.norm();
  const float along_m = way_m.dot(to_point_m) / length_m;
  if (!(along_m > 0.0F) || along_m > length_m - beyond_m) return false;
  return to_point_m.squaredNorm() - along_m * along_m < radius_m * radius_m;
}

}  // namespace pllit
