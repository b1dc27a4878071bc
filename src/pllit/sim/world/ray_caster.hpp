// Rays against a place.
#pragma once

#include <memory>
#include <span>

#include "pllit/sim/world/place.hpp"

namespace pllit {

struct Ray {
  Eigen::Vector3d origin_W;
  Eigen::Vector3d direction_W;  ///< unit
};

struct Hit {
  static constexpr std::uint32_t kStatic = 0xffffffff;
  float range_m = -1.0F;     ///< negative: nothing within reach
  Eigen::Vector3f normal_W;  ///< unit, towards the ray's origin
  /// Where textures are read: of actors the point in the mesh's frame, else the point in W less the multiple of 1024 m
  /// nearest its tile's origin, so that float resolves 0.06 mm.
  Eigen::Vector3f p_own;
  std::uint32_t surface = 0;  ///< index into Place::surfaces()
  float warmer_K = 0.0F;
  std::uint32_t actor = kStatic;  ///< index into Place::actors()
  explicit operator bool() const { return range_m >= 0.0F; }
};

/// Casts rays with Embree. Holds the tiles around the last position that it was moved to, and the actors as they were
/// then. Not copied; cast() is const and may be called from several threads.
class RayCaster {
 public:
  /// The place must outlive the caster. reach_m: how far rays go.
  RayCaster(const Place& place, double reach_m);
  RayCaster(RayCaster&&) noexcept;
  ~RayCaster();

  /// Makes the tiles within reach of p_W, drops those well beyond it, and puts the actors where they are at t_s. To be
  /// called before rays are cast from there.
  void move_to(const Eigen::Vector3d& p_W, double t_s);

  Hit cast(const Ray& ray) const;
  /// Many at once, the same hits to the bit; faster where neighbours in the list run side by side.
  void cast(std::span<const Ray> rays, std::span<Hit> hits) const;
  /// Whether anything lies between two points (1 mm at either end apart).
  bool blocked(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W) const;
  /// The same of many points, each and the one `way_W` from it.
  void blocked(std::span<const Eigen::Vector3d> from_W, const Eigen::Vector3d& way_W, std::span<bool> answers) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace pllit
