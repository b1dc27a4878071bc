// What a camera may show, as a solid: four sides and a reach.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "pllit/geometry/camera.hpp"
#include "pllit/geometry/lie.hpp"

namespace pllit {

struct ViewFrustum {
  Vector3d apex_W = Vector3d::Zero();
  std::array<Vector3d, 4> inward_W;  ///< unit normals of its sides; zero: open on that side
  double reach_m = std::numeric_limits<double>::infinity();

  bool contains(const Vector3d& p_W) const { return may_show(p_W, 0.0); }
  /// Whether it holds any point of a ball; true as well for some balls next to it.
  bool may_show(const Vector3d& middle_W, double radius_m) const {
    const Vector3d ray_W = middle_W - apex_W;
    const double far_m = reach_m + radius_m;
    return ray_W.squaredNorm() <= far_m * far_m &&
           std::ranges::all_of(inward_W, [&](const Vector3d& normal_W) { return normal_W.dot(ray_W) >= -radius_m; });
  }
};

/// Holds everything that an image may show as far as `reach_m`, and so much more to all sides; at most 85 degrees to
/// each side of the optical axis.
ViewFrustum view_frustum(const SE3& T_W_C, const Camera& camera,
                         double reach_m = std::numeric_limits<double>::infinity(), double margin_rad = 0.01);

}  // namespace pllit
