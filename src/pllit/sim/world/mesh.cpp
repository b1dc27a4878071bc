#include "pllit/sim/world/mesh.hpp"

#include <algorithm>

namespace pllit {

void Mesh::append(const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
  triangles.reserve(triangles.size() + other.triangles.size());
  for (const auto& [a, b, c] : other.triangles) triangles.push_back({a + first, b + first, c + first});
  surface.insert(surface.end(), other.surface.begin(), other.surface.end());
  warmer_K.insert(warmer_K.end(), other.warmer_K.begin(), other.warmer_K.end());
}

SE3 Actor::pose(double t_s) const {
  const auto next =
      std::upper_bound(path.begin(), path.end(), t_s, [](double t, const Waypoint& point) { return t < point.at_s; });
  if (next == path.begin()) return path.front().T_W_O;
  const Waypoint& before = *(next - 1);
  if (next == path.end()) return before.T_W_O;
  const double share = (t_s - before.at_s) / (next->at_s - before.at_s);
  const Vector3d p_W = (1.0 - share) * before.T_W_O.translation() + share * next->T_W_O.translation();
  return pose_from(rotation_from(before.T_W_O.quat().slerp(share, next->T_W_O.quat())), p_W);
}

}  // namespace pllit
