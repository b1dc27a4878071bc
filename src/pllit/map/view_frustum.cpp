#include "pllit/map/view_frustum.hpp"

#include <cmath>

namespace pllit {

ViewFrustum view_frustum(const SE3& T_W_C, const Camera& camera, double reach_m, double margin_rad) {
  constexpr double kMost_rad = 1.48;
  std::array<double, 4> angle_rad{};  // left, right, up, down
  const double right_px = camera.width - 1.0, bottom_px = camera.height - 1.0;
  for (const double x : {0.0, 0.5, 1.0})
    for (const double y : {0.0, 0.5, 1.0}) {
      const Vector3d ray_C = camera.ray({x * right_px, y * bottom_px});
      const double across_rad = std::atan2(ray_C.x(), ray_C.z()), down_rad = std::atan2(ray_C.y(), ray_C.z());
      const std::array<double, 4> here_rad{-across_rad, across_rad, -down_rad, down_rad};
      for (std::size_t i = 0; i < 4; ++i) angle_rad[i] = std::max(angle_rad[i], here_rad[i]);
    }
  const auto inward_W = [&](std::size_t side) -> Vector3d {
    const double angle = std::min(kMost_rad, angle_rad[side] + margin_rad);
    const double across = (side % 2 == 0 ? 1.0 : -1.0) * std::cos(angle);
    return T_W_C.rotation() *
           (side < 2 ? Vector3d(across, 0.0, std::sin(angle)) : Vector3d(0.0, across, std::sin(angle)));
  };
  return {T_W_C.translation(), {inward_W(0), inward_W(1), inward_W(2), inward_W(3)}, reach_m};
}

}  // namespace pllit
