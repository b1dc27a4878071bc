#include "pllit/sim/sightings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pllit {
namespace {

struct Window {
  int left, top, right, bottom;  // inclusive
};

/// The pixels that an actor's corners span; nothing where it lies behind the camera, outside the image or all of it too
/// far away.
std::optional<Window> window_of(const Actor& actor, const Camera& camera, const SE3& T_C_O) {
  Eigen::AlignedBox2d box;
  bool near = false;
  for (const Eigen::Vector3f& vertex : actor.mesh_O.vertices) {
    const Vector3d p_C = T_C_O.act(vertex.cast<double>());
    near |= p_C.norm() <= Sightings::kFarthest_m;
    if (const auto pixel = camera.project(p_C)) box.extend(*pixel);
  }
  if (!near || box.isEmpty()) return std::nullopt;
  const Eigen::AlignedBox2d image(Eigen::Vector2d::Zero(), Eigen::Vector2d(camera.width - 1.0, camera.height - 1.0));
  const Eigen::AlignedBox2d seen = box.intersection(image);
  if (seen.isEmpty()) return std::nullopt;
  const auto floor_of = [](double v) { return static_cast<int>(std::floor(v)); };
  return Window{floor_of(seen.min().x()), floor_of(seen.min().y()), floor_of(seen.max().x()), floor_of(seen.max().y())};
}

/// Points of an actor, near enough, that every step-th pixel of a window shows, in its own frame; no more than `most`.
std::vector<Vector3f> points_in(const Window& window, int step, std::size_t most, std::uint32_t actor,
                                const RayCaster& caster, const Camera& camera, const SE3& T_W_C) {
  const Matrix3d R_W_C = T_W_C.rotation();
  std::vector<Vector3f> points_O;
  for (int v = window.top; v <= window.bottom; v += step)
    for (int u = window.left; u <= window.right && points_O.size() < most; u += step) {
      const Hit hit = caster.cast(Ray{T_W_C.translation(), R_W_C * camera.ray({u, v})});
      const bool near = hit && static_cast<double>(hit.range_m) <= Sightings::kFarthest_m;
      if (near && hit.actor == actor) points_O.push_back(hit.p_own);
    }
  return points_O;
}

/// Of a window in which so many rays are enough.
int step_of(const Window& window) {
  constexpr double kRays = 2500.0;
  const double pixels = (window.right - window.left + 1.0) * (window.bottom - window.top + 1.0);
  return std::max(1, static_cast<int>(std::sqrt(pixels / kRays)));
}

}  // namespace

double begins_s(const Actor& actor) {
  return actor.heating.empty() ? actor.appears_s : std::max(actor.appears_s, actor.heating.front().at_s);
}

double hot_from_s(const Actor& actor) {
  constexpr double kHot_K = 5.0, kMost = 0.8;
  if (actor.heating.empty()) return actor.appears_s;
  const Actor::Heating& heating = actor.heating.front();
  const double share = std::min(kMost, kHot_K / std::abs(static_cast<double>(heating.by_K)));
  return std::max(actor.appears_s, heating.at_s - heating.over_s * std::log1p(-share));
}

void Sighting::add(const Vector3f& p_O, double range_m) {
  nearest_m = std::min(nearest_m.value_or(range_m), range_m);
  Patch& patch = patches_[voxel_key(voxel_of(p_O, 1.0F / static_cast<float>(kPatch_m)))];
  patch.sum_m += p_O;
  patch.points += 1.0F;
}

std::optional<Vector3d> Sighting::centroid_O() const {
  if (patches_.empty()) return std::nullopt;
  Vector3d sum_m = Vector3d::Zero();
  for (const auto& [key, patch] : patches_) sum_m += (patch.sum_m / patch.points).cast<double>();
  return sum_m / static_cast<double>(patches_.size());
}

void Sightings::look(const RayCaster& caster, const Camera& camera, const SE3& T_W_C, double t_s) {
  for (std::uint32_t i = 0; i < seen_.size(); ++i) {
    const Actor& actor = place_->actors()[i];
    if (!actor.finding || t_s < hot_from_s(actor) || t_s > actor.vanishes_s) continue;
    const SE3 T_C_O = T_W_C.inverse() * actor.path.front().T_W_O;
    const auto window = window_of(actor, camera, T_C_O);
    if (!window) continue;
    Sighting& sighting = seen_[i];
    if (!sighting.first_s && points_in(*window, 1, kPixels, i, caster, camera, T_W_C).size() == kPixels)
      sighting.first_s = t_s;
    if (!sighting.first_s) continue;
    constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
    for (const Vector3f& p_O : points_in(*window, step_of(*window), kAll, i, caster, camera, T_W_C))
      sighting.add(p_O, T_C_O.act(p_O.cast<double>()).norm());
  }
}

}  // namespace pllit
