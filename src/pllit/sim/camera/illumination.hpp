// How bright everything is to the eye.
#pragma once

#include <span>
#include <vector>

#include "pllit/sim/world/ray_caster.hpp"

namespace pllit {

/// A place's light at one moment, in units of a white surface in full light: sun with shadows, light from everywhere
/// that is strongest from above, and what glows by itself (which lights nothing else).
class Illumination {
 public:
  /// t_s: since the start of the motion. pixel_rad: the angle a pixel sees, below which textures blur. The place must
  /// outlive it.
  Illumination(const Place& place, double t_s, float pixel_rad);

  /// Brightness of the samples of some pixels, `samples` each. Shadows and mirrored things are sought by one further
  /// ray for each surface in a pixel, and where its texture is smooth one value stands for its samples.
  void shade(const RayCaster& caster, std::span<const Ray> rays, std::span<const Hit> hits, std::size_t samples,
             std::span<float> brightness) const;

 private:
  float reflected_and_glow(const Hit& hit, bool in_sun) const;
  float sky(const Eigen::Vector3f& direction_W) const;

  const std::vector<Surface>* surfaces_;
  float pixel_rad_, sun_, ambient_;
  Eigen::Vector3f to_sun_W_;
  std::vector<Eigen::Matrix3f> R_O_W_;  ///< of the actors
};

}  // namespace pllit
