// What a pixel sees of one surface, and what further rays tell about it.
#pragma once

#include <span>
#include <vector>

#include "pllit/sim/camera/own_frame.hpp"

namespace pllit {

/// Mirrors below this share are the gloss of paint and varnish, which scatters: nothing is seen in them.
inline constexpr float kLeastMirror = 0.035F;

/// Whether the sun meets a surface is asked from this near it, and so far.
inline constexpr double kOffSurface_m = 0.01, kSunReach_m = 150.0;

/// Where a ray has hit, a little off the surface.
inline Eigen::Vector3d off_surface_W(const Ray& ray, const Hit& hit) {
  return ray.origin_W + hit.range_m * ray.direction_W + kOffSurface_m * hit.normal_W.cast<double>();
}

/// The samples of some pixels, gathered into patches: those of one pixel on one surface with one normal at about one
/// range, or in the sky. One further ray of a kind is cast for a patch, from its first sample.
class Patches {
 public:
  /// The samples of one pixel stand together.
  Patches(std::span<const Ray> rays, std::span<const Hit> hits, std::size_t samples);

  /// Index of the first sample in the patch of sample i.
  std::size_t first(std::size_t i) const { return first_[i]; }

  /// Finds out for the patches that wants(ray, hit) whether the sun meets them.
  template <class Wants>
  void seek_sun(const RayCaster& caster, const Eigen::Vector3f& to_sun_W, const Wants& wants) {
    const auto chosen = those(wants);
    if (!chosen.empty()) seek_sun_of(chosen, caster, to_sun_W.cast<double>());
  }
  /// Finds out what the patches that wants(ray, hit) mirror.
  template <class Wants>
  void seek_mirrored(const RayCaster& caster, const Wants& wants) {
    const auto chosen = those(wants);
    if (!chosen.empty()) seek_mirrored_of(chosen, caster);
  }

  /// Of sample i's patch; false where nothing was sought.
  bool in_sun(std::size_t i) const { return !in_sun_.empty() && in_sun_[first_[i]] != 0; }

  struct Mirrored {
    Ray ray;
    Hit hit;
  };
  /// Null where nothing was sought.
  const Mirrored* mirrored(std::size_t i) const {
    return mirrored_of_.empty() || mirrored_of_[first_[i]] == 0 ? nullptr : &mirrored_[mirrored_of_[first_[i]] - 1];
  }

 private:
  template <class Wants>
  std::vector<std::size_t> those(const Wants& wants) const {
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < hits_.size(); ++i)
      if (first_[i] == i && hits_[i] && wants(rays_[i], hits_[i])) chosen.push_back(i);
    return chosen;
  }
  void seek_sun_of(const std::vector<std::size_t>& chosen, const RayCaster& caster, const Eigen::Vector3d& to_sun_W);
  void seek_mirrored_of(const std::vector<std::size_t>& chosen, const RayCaster& caster);

  std::span<const Ray> rays_;
  std::span<const Hit> hits_;
  std::vector<std::size_t> first_;
  std::vector<std::uint8_t> in_sun_;
  std::vector<std::size_t> mirrored_of_;  ///< one more than the place in mirrored_
  std::vector<Mirrored> mirrored_;
};

}  // namespace pllit
