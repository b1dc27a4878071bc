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

float Heat::sky_K(const Vector3f& direction_W) const {
  const float up = std::max(0.0F, direction_W.z());
  const float clear_K = clear_sky_K(up);
  const Texture cover{.kind = Texture::Kind::clouds, .scale_m = 1.2F, .contrast = 1.0F, .seed = 71};
  const Vector3f dome(direction_W.x() / (up + 0.1F), direction_W.y() / (up + 0.1F), 0.5F);
  const float cloud = std::max(0.0F, texture_value(cover, dome, Vector3f::UnitZ(), 0.0F));
  return clear_K + 0.35F * cloud * (air_K_ - clear_K);
}

bool Heat::in_sun(const RayCaster& caster, const Ray& ray, const Hit& hit) const {
  if (sun_ <= 0.0F || surfaces_[hit.surface].sun_K == 0.0F || hit.normal_W.dot(to_sun_W_) <= 0.0F) return false;
  constexpr double far_m = 150.0, off_m = 0.01;
  const Vector3d p_W = ray.origin_W + hit.range_m * ray.direction_W + off_m * hit.normal_W.cast<double>();
  return !caster.blocked(p_W, p_W + far_m * to_sun_W_.cast<double>());
}

/// Emissivity falls beyond about 60 degrees (Schlick's approximation of Fresnel's reflection).
float Heat::emissivity(const Hit& hit, float cos_view) const {
  const float c = 1.0F - std::clamp(cos_view, 0.0F, 1.0F);
  return surfaces_[hit.surface].emissivity * (1.0F - c * c * c * c * c);
}

float Heat::emitted_and_reflected(const Hit& hit, const Vector3f& direction_W, bool in_sun, float mirrored) const {
  const Warmth& surface = surfaces_[hit.surface];
  const float cos_view = -direction_W.dot(hit.normal_W);
  const float emits = emissivity(hit, cos_view);
  float ambient = band_.radiance(air_K_);
  if (surface.sees_sky > 0.0F) {
    // At grazing angles, where it matters, what is reflected comes from near the mirrored ray.
    const float up = std::max(0.0F, direction_W.z() + 2.0F * cos_view * hit.normal_W.z());
    ambient = std::lerp(ambient, band_.radiance(clear_sky_K(up)), surface.sees_sky);
  }
  return emits * band_.radiance(temperature_K(hit, in_sun)) +
         (1.0F - emits) * std::lerp(ambient, mirrored, surface.mirror);
}

void Heat::shade(const RayCaster& caster, std::span<const Ray> rays, std::span<const Hit> hits,
                 std::span<float> radiance) const {
  std::uint32_t known = Hit::kStatic;  // the surface that the two below were found for
  bool lit = false;
  float mirrored = 0.0F;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit& hit = hits[i];
    const Vector3f direction_W = rays[i].direction_W.cast<float>();
    if (!hit) {
      radiance[i] = band_.radiance(sky_K(direction_W));
      continue;
    }
    if (hit.surface != known) {
      known = hit.surface;
      lit = in_sun(caster, rays[i], hit);
      if (surfaces_[known].mirror > 0.0F) {
        const Ray second = mirrored_ray(rays[i], hit);
        const Hit seen = caster.cast(second);
        mirrored =
            seen ? band_.radiance(temperature_K(seen, false)) : band_.radiance(sky_K(second.direction_W.cast<float>()));
      }
    }
    radiance[i] = emitted_and_reflected(hit, direction_W, lit, mirrored);
  }
}

}  // namespace pllit
