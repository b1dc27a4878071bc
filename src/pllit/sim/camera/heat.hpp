// How warm everything is, and what it radiates.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pllit/sim/camera/patches.hpp"
#include "pllit/sim/camera/thermal_band.hpp"
#include "pllit/sim/world/ray_caster.hpp"

namespace pllit {

/// A place's heat at one moment. A surface is as warm as the air at the start plus its excess, its mesh's own, its
/// share of what the air did since, what the sun adds where it meets it, less what it loses to the sky, plus its
/// texture and, on actors, their heatings: each a first-order approach that begins at its time. It radiates 8 to 14 um
/// by Planck's law times an emissivity that falls towards grazing angles, and reflects the rest: from the sky and from
/// surroundings as warm as the air, or as a mirror.
class Heat {
 public:
  /// t_s: since the start of the motion. pixel_rad: the angle a pixel sees, below which textures blur. Place and band
  /// must outlive it.
  Heat(const Place& place, const ThermalBand& band, double t_s, float pixel_rad);

  /// Kinetic temperature at a hit; in_sun: nothing stands between it and the sun.
  float temperature_K(const Hit& hit, bool in_sun) const;
  /// Radiance, W/m2/sr, that the samples of some pixels receive, `samples` each. Shadows and mirrored things are sought
  /// by one further ray for each surface in a pixel, and where its texture is smooth one value stands for its samples.
  void shade(const RayCaster& caster, std::span<const Ray> rays, std::span<const Hit> hits, std::size_t samples,
             std::span<float> radiance) const;
  /// Apparent temperature of the sky: air's at the horizon, Climate::sky_K at the zenith, patchy with clouds.
  float sky_K(const Eigen::Vector3f& direction_W) const;
  /// Whether the sun warms a hit: it stands in the sky, on the surface's side, with nothing between.
  bool in_sun(const RayCaster& caster, const Ray& ray, const Hit& hit) const;

 private:
  struct Warmth {
    float base_K, sun_K, emissivity, sees_sky, mirror;
    Texture texture;
  };
  float emitted_and_reflected(const Hit& hit, const Eigen::Vector3f& direction_W, bool in_sun,
                              std::optional<float> mirrored) const;
  float clear_sky_K(float up) const;
  float clear_sky_radiance(float up) const;
  bool sun_may_warm(const Hit& hit) const;
  float mirrored_radiance(const Patches::Mirrored& mirrored) const;
  float emissivity(const Hit& hit, float cos_view) const;
  Eigen::Vector3f normal_own(const Hit& hit) const;

  const ThermalBand& band_;
  float air_K_, air_radiance_, zenith_K_, pixel_rad_, sun_;
  Eigen::Vector3f to_sun_W_;
  std::vector<float> clear_sky_;  ///< radiance by height above the horizon, 0 to 1
  std::vector<Warmth> surfaces_;
  std::vector<float> actor_K_;
  std::vector<Eigen::Matrix3f> R_O_W_;  ///< of the actors
};

}  // namespace pllit
