#include "pllit/sim/camera/heat.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pllit/sim/camera/own_frame.hpp"
#include "pllit/sim/camera/texture.hpp"

namespace pllit {
namespace {

/// Share of the difference between air and sky by which a surface under an open sky stays below the air.
constexpr float kSkyCooling = 0.12F;

/// Share of what is received below which nothing is sought in a mirror: 10 K more there would show as 0.04 K.
constexpr float kLeastReflected = 0.004F;
constexpr int kSkySteps = 256;

double air_change_K(const Climate& climate, double t_s) {
  constexpr double day_s = 86400.0;
  return climate.air_drift_Kph * t_s / 3600.0 + climate.air_swing_K * std::sin(2.0 * std::numbers::pi * t_s / day_s);
}

float heated_K(const Actor& actor, double t_s) {
  double sum = 0.0;
  for (const Actor::Heating& heating : actor.heating)
    if (t_s > heating.at_s) sum -= heating.by_K * std::expm1(-(t_s - heating.at_s) / std::max(heating.over_s, 1e-3));
  return static_cast<float>(sum);
}

}  // namespace

Heat::Heat(const Place& place, const ThermalBand& band, double t_s, float pixel_rad)
    : band_(band),
      zenith_K_(static_cast<float>(place.climate().sky_K)),
      pixel_rad_(pixel_rad),
      sun_(static_cast<float>(place.climate().sun)),
      to_sun_W_(place.climate().to_sun_W.cast<float>()) {
  const Climate& climate = place.climate();
  const auto start_K = static_cast<float>(climate.air_K), change_K = static_cast<float>(air_change_K(climate, t_s));
  air_K_ = start_K + change_K;
  air_radiance_ = band_.radiance(air_K_);
  for (int i = 0; i <= kSkySteps; ++i)
    clear_sky_.push_back(band_.radiance(clear_sky_K(static_cast<float>(i) / kSkySteps)));
  for (const Surface& surface : place.surfaces()) {
    const float cooling_K = kSkyCooling * surface.sees_sky * std::max(0.0F, air_K_ - zenith_K_);
    const float base_K = start_K + surface.excess_K + surface.follows_air * change_K - cooling_K;
    surfaces_.push_back({base_K, surface.sun_K, surface.emissivity, surface.sees_sky, surface.mirror, surface.heat});
  }
  for (const Actor& actor : place.actors()) {
    actor_K_.push_back(heated_K(actor, t_s));
    R_O_W_.push_back(rotation_to_own(actor, t_s));
  }
}

Vector3f Heat::normal_own(const Hit& hit) const {
  return hit.actor == Hit::kStatic ? hit.normal_W : Vector3f(R_O_W_[hit.actor] * hit.normal_W);
}

float Heat::temperature_K(const Hit& hit, bool in_sun) const {
  const Warmth& surface = surfaces_[hit.surface];
  float sum_K = surface.base_K + hit.warmer_K;
  if (in_sun) sum_K += surface.sun_K * sun_ * std::max(0.0F, hit.normal_W.dot(to_sun_W_));
  if (hit.actor != Hit::kStatic) sum_K += actor_K_[hit.actor];
  if (surface.texture.contrast != 0.0F)
    sum_K +=
        surface.texture.contrast * texture_value(surface.texture, hit.p_own, normal_own(hit), pixel_rad_ * hit.range_m);
  return sum_K;
}

/// up: z of the unit direction.
float Heat::clear_sky_K(float up) const { return zenith_K_ + (air_K_ - zenith_K_) * std::exp(-up / 0.22F); }

float Heat::clear_sky_radiance(float up) const {
  const float place = std::min(up, 1.0F) * kSkySteps;
  const std::size_t index = std::min(static_cast<std::size_t>(place), clear_sky_.size() - 2);
  return clear_sky_[index] + (place - static_cast<float>(index)) * (clear_sky_[index + 1] - clear_sky_[index]);
}

float Heat::sky_K(const Vector3f& direction_W) const {
  const float up = std::max(0.0F, direction_W.z());
  const float clear_K = clear_sky_K(up);
  const Texture cover{.kind = Texture::Kind::clouds, .scale_m = 1.2F, .contrast = 1.0F, .seed = 71};
  const Vector3f dome(direction_W.x() / (up + 0.1F), direction_W.y() / (up + 0.1F), 0.5F);
  const float cloud = std::max(0.0F, texture_value(cover, dome, Vector3f::UnitZ(), 0.0F));
  return clear_K + 0.35F * cloud * (air_K_ - clear_K);
}

bool Heat::sun_may_warm(const Hit& hit) const {
  return sun_ > 0.0F && surfaces_[hit.surface].sun_K != 0.0F && hit.normal_W.dot(to_sun_W_) > 0.0F;
}

bool Heat::in_sun(const RayCaster& caster, const Ray& ray, const Hit& hit) const {
  if (!sun_may_warm(hit)) return false;
  const Vector3d p_W = off_surface_W(ray, hit);
  return !caster.blocked(p_W, p_W + kSunReach_m * to_sun_W_.cast<double>());
}

/// Emissivity falls beyond about 60 degrees (Schlick's approximation of Fresnel's reflection).
float Heat::emissivity(const Hit& hit, float cos_view) const {
  const float c = 1.0F - std::clamp(cos_view, 0.0F, 1.0F);
  return surfaces_[hit.surface].emissivity * (1.0F - c * c * c * c * c);
}

float Heat::emitted_and_reflected(const Hit& hit, const Vector3f& direction_W, bool in_sun,
                                  std::optional<float> mirrored) const {
  const Warmth& surface = surfaces_[hit.surface];
  const float cos_view = -direction_W.dot(hit.normal_W);
  const float emits = emissivity(hit, cos_view);
  float ambient = air_radiance_;
  if (surface.sees_sky > 0.0F) {
    // At grazing angles, where it matters, what is reflected comes from near the mirrored ray.
    const float up = std::max(0.0F, direction_W.z() + 2.0F * cos_view * hit.normal_W.z());
    ambient += surface.sees_sky * (clear_sky_radiance(up) - ambient);
  }
  if (mirrored) ambient += surface.mirror * (*mirrored - ambient);
  return emits * band_.radiance(temperature_K(hit, in_sun)) + (1.0F - emits) * ambient;
}

float Heat::mirrored_radiance(const Patches::Mirrored& mirrored) const {
  return mirrored.hit ? band_.radiance(temperature_K(mirrored.hit, false))
                      : band_.radiance(sky_K(mirrored.ray.direction_W.cast<float>()));
}

void Heat::shade(const RayCaster& caster, std::span<const Ray> rays, std::span<const Hit> hits, std::size_t samples,
                 std::span<float> radiance) const {
  Patches patches(rays, hits, samples);
  if (sun_ > 0.0F) patches.seek_sun(caster, to_sun_W_, [&](const Ray&, const Hit& hit) { return sun_may_warm(hit); });
  patches.seek_mirrored(caster, [&](const Ray& ray, const Hit& hit) {
    const Warmth& surface = surfaces_[hit.surface];
    if (surface.mirror < kLeastMirror) return false;
    return (1.0F - emissivity(hit, -ray.direction_W.cast<float>().dot(hit.normal_W))) * surface.mirror >
           kLeastReflected;
  });
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit& hit = hits[i];
    const bool smooth = !hit || is_smooth(surfaces_[hit.surface].texture);
    if (smooth && patches.first(i) != i) {
      radiance[i] = radiance[patches.first(i)];
      continue;
    }
    const Vector3f direction_W = rays[i].direction_W.cast<float>();
    if (!hit) {
      radiance[i] = band_.radiance(sky_K(direction_W));
      continue;
    }
    const Patches::Mirrored* mirrored = patches.mirrored(i);
    radiance[i] = emitted_and_reflected(hit, direction_W, patches.in_sun(i),
                                        mirrored ? std::optional(mirrored_radiance(*mirrored)) : std::nullopt);
  }
}

}  // namespace pllit
