#include "pllit/sim/camera/illumination.hpp"

#include <algorithm>
#include <cmath>

#include "pllit/sim/camera/own_frame.hpp"
#include "pllit/sim/camera/patches.hpp"
#include "pllit/sim/camera/texture.hpp"

namespace pllit {

Illumination::Illumination(const Place& place, double t_s, float pixel_rad)
    : surfaces_(&place.surfaces()),
      pixel_rad_(pixel_rad),
      sun_(static_cast<float>(place.climate().sun)),
      ambient_(static_cast<float>(place.climate().ambient_light)),
      to_sun_W_(place.climate().to_sun_W.cast<float>()) {
  for (const Actor& actor : place.actors()) R_O_W_.push_back(rotation_to_own(actor, t_s));
}

float Illumination::sky(const Vector3f& direction_W) const {
  const float up = std::max(0.0F, direction_W.z());
  const Texture cover{.kind = Texture::Kind::clouds, .scale_m = 1.2F, .contrast = 1.0F, .seed = 71};
  const Vector3f dome(direction_W.x() / (up + 0.1F), direction_W.y() / (up + 0.1F), 0.5F);
  const float cloud = std::max(0.0F, texture_value(cover, dome, Vector3f::UnitZ(), 0.0F));
  return (ambient_ + 0.2F * sun_) * (1.1F - 0.35F * up + 0.3F * cloud);
}

float Illumination::reflected_and_glow(const Hit& hit, bool in_sun) const {
  const Surface& surface = (*surfaces_)[hit.surface];
  const Vector3f normal_own = hit.actor == Hit::kStatic ? hit.normal_W : Vector3f(R_O_W_[hit.actor] * hit.normal_W);
  float albedo = surface.albedo;
  if (surface.paint.contrast != 0.0F)
    albedo += surface.paint.contrast * texture_value(surface.paint, hit.p_own, normal_own, pixel_rad_ * hit.range_m);
  const Vector3f main_W(0.27F, 0.53F,
                        0.80F);  // where most of the ambient light comes from, so that no two walls look alike
  float light = ambient_ * (0.7F + 0.3F * hit.normal_W.dot(main_W));
  if (in_sun) light += sun_ * hit.normal_W.dot(to_sun_W_);
  return std::clamp(albedo, 0.02F, 1.0F) * light + surface.glow;
}

void Illumination::shade(const RayCaster& caster, std::span<const Ray> rays, std::span<const Hit> hits,
                         std::size_t samples, std::span<float> brightness) const {
  Patches patches(rays, hits, samples);
  if (sun_ > 0.0F)
    patches.seek_sun(caster, to_sun_W_, [&](const Ray&, const Hit& hit) { return hit.normal_W.dot(to_sun_W_) > 0.0F; });
  patches.seek_mirrored(caster,
                        [&](const Ray&, const Hit& hit) { return (*surfaces_)[hit.surface].mirror >= kLeastMirror; });
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit& hit = hits[i];
    const bool smooth = !hit || is_smooth((*surfaces_)[hit.surface].paint);
    if (smooth && patches.first(i) != i) {
      brightness[i] = brightness[patches.first(i)];
      continue;
    }
    if (!hit) {
      brightness[i] = sky(rays[i].direction_W.cast<float>());
      continue;
    }
    brightness[i] = reflected_and_glow(hit, patches.in_sun(i));
    if (const Patches::Mirrored* mirrored = patches.mirrored(i)) {
      const float seen =
          mirrored->hit ? reflected_and_glow(mirrored->hit, false) : sky(mirrored->ray.direction_W.cast<float>());
      brightness[i] += (*surfaces_)[hit.surface].mirror * (seen - brightness[i]);
    }
  }
}

}  // namespace pllit
