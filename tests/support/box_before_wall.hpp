// What a scanner at the origin meets: a wall, and a box before it.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "support/random_states.hpp"

namespace pllit::test {

/// A wall at x = 4 m, and from x = 2 m on a box that reaches so far to each side, where there is one.
inline std::vector<Vector3f> box_before_wall(std::optional<double> half_m) {
  Random random(7);
  std::vector<Vector3f> points_W;
  for (int i = 0; i < 12000; ++i) {
    const Vector3d ray(1.0, random.uniform(-0.55, 0.55), random.uniform(-0.45, 0.45));
    const bool hits_box = half_m && std::abs(2.0 * ray.y()) < *half_m && std::abs(2.0 * ray.z()) < *half_m;
    points_W.push_back(((hits_box ? 2.0 : 4.0) * ray).cast<float>());
  }
  return points_W;
}

}  // namespace pllit::test
