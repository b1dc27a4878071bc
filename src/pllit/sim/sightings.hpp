// When a camera first had a chance to see what is to be found.
#pragma once

#include <optional>
#include <vector>

#include "pllit/geometry/camera.hpp"
#include "pllit/sim/world/ray_caster.hpp"

namespace pllit {

/// One entry an actor of the place; nothing for those that are no findings or were never seen.
class Sightings {
 public:
  static constexpr int kPixels = 25;  ///< unoccluded ones that make a sighting

  explicit Sightings(const Place* place) : place_(place), first_s_(place ? place->actors().size() : 0) {}

  /// A frame at t_s since the start: findings that have begun to
  /// be one (they appeared, or heat up) and fill enough pixels.
  void look(const RayCaster& caster, const Camera& camera, const SE3& T_W_C, double t_s);
  const std::vector<std::optional<double>>& first_s() const { return first_s_; }

 private:
  const Place* place_;
  std::vector<std::optional<double>> first_s_;
};

/// When an actor becomes a finding: as it appears, or with its first heating.
double begins_s(const Actor& actor);

}  // namespace pllit
