#include "pllit/sim/camera/patches.hpp"

#include <cmath>
#include <memory>

namespace pllit {
namespace {

constexpr float kSameNormal = 0.99F;  // cosine
constexpr float kSameRange = 0.02F;   // relative

bool alike(const Hit& a, const Hit& b) {
  if (!a || !b) return !a && !b;
  return a.surface == b.surface && a.actor == b.actor && a.warmer_K == b.warmer_K &&
         a.normal_W.dot(b.normal_W) > kSameNormal && std::abs(a.range_m - b.range_m) < kSameRange * a.range_m;
}

}  // namespace

Patches::Patches(std::span<const Ray> rays, std::span<const Hit> hits, std::size_t samples)
    : rays_(rays), hits_(hits), first_(hits.size()) {
  for (std::size_t pixel = 0; pixel < hits.size(); pixel += samples)
    for (std::size_t i = pixel; i < pixel + samples; ++i) {
      std::size_t first = pixel;
      while (first < i && (first_[first] != first || !alike(hits[first], hits[i]))) ++first;
      first_[i] = first;
    }
}

void Patches::seek_sun_of(const std::vector<std::size_t>& chosen, const RayCaster& caster, const Vector3d& to_sun_W) {
  std::vector<Vector3d> from_W;
  for (const std::size_t i : chosen) from_W.push_back(off_surface_W(rays_[i], hits_[i]));
  const auto in_shade = std::make_unique<bool[]>(chosen.size());
  caster.blocked(from_W, kSunReach_m * to_sun_W, {in_shade.get(), chosen.size()});
  in_sun_.assign(hits_.size(), 0);
  for (std::size_t k = 0; k < chosen.size(); ++k) in_sun_[chosen[k]] = !in_shade[k];
}

void Patches::seek_mirrored_of(const std::vector<std::size_t>& chosen, const RayCaster& caster) {
  mirrored_of_.assign(hits_.size(), 0);
  for (const std::size_t i : chosen) {
    const Ray ray = mirrored_ray(rays_[i], hits_[i]);
    mirrored_.push_back({ray, caster.cast(ray)});
    mirrored_of_[i] = mirrored_.size();
  }
}

}  // namespace pllit
