#include "pllit/sim/sightings.hpp"

#include <algorithm>
#include <cmath>

namespace pllit {
namespace {

constexpr double kFarthest_m = 15.0;

struct Window {
  int left, top, right, bottom;  // inclusive
};

/// The pixels that an actor's corners span; nothing where it lies behind the camera, outside the image or too far away.
std::optional<Window> window_of(const Actor& actor, const Camera& camera, const SE3& T_C_O) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3f& vertex : actor.mesh_O.vertices) {
    const Vector3d p_C = T_C_O.act(vertex.cast<double>());
    if (p_C.norm() > kFarthest_m) return std::nullopt;
    if (const auto pixel = camera.project(p_C)) box.extend(*pixel);
  }
  if (box.isEmpty()) return std::nullopt;
  const Eigen::AlignedBox2d image(Eigen::Vector2d::Zero(), Eigen::Vector2d(camera.width - 1.0, camera.height - 1.0));
  const Eigen::AlignedBox2d seen = box.intersection(image);
  if (seen.isEmpty()) return std::nullopt;
  const auto floor_of = [](double v) { return static_cast<int>(std::floor(v)); };
  return Window{floor_of(seen.min().x()), floor_of(seen.min().y()), floor_of(seen.max().x()), floor_of(seen.max().y())};
}

bool fills_enough(std::uint32_t actor, const Window& window, const RayCaster& caster, const Camera& camera,
                  const SE3& T_W_C) {
  const Matrix3d R_W_C = T_W_C.rotation();
  int pixels = 0;
  for (int v = window.top; v <= window.bottom; ++v)
    for (int u = window.left; u <= window.right; ++u) {
      const Hit hit = caster.cast(Ray{T_W_C.translation(), R_W_C * camera.ray({u, v})});
      pixels += hit && hit.actor == actor;
      if (pixels >= Sightings::kPixels) return true;
    }
  return false;
}

}  // namespace

double begins_s(const Actor& actor) {
  return actor.heating.empty() ? actor.appears_s : std::max(actor.appears_s, actor.heating.front().at_s);
}

void Sightings::look(const RayCaster& caster, const Camera& camera, const SE3& T_W_C, double t_s) {
  for (std::uint32_t i = 0; i < first_s_.size(); ++i) {
    const Actor& actor = place_->actors()[i];
    if (!actor.finding || first_s_[i] || t_s < begins_s(actor) || t_s > actor.vanishes_s) continue;
    const auto window = window_of(actor, camera, T_W_C.inverse() * actor.path.front().T_W_O);
    if (window && fills_enough(i, *window, caster, camera, T_W_C)) first_s_[i] = t_s;
  }
}

}  // namespace pllit
