// Small geometry that heat and light share.
#pragma once

#include "pllit/sim/world/ray_caster.hpp"

namespace pllit {

/// R_O_W of an actor at a time.
Eigen::Matrix3f rotation_to_own(const Actor& actor, double t_s);

/// The ray that leaves a hit as from a mirror, from 2 mm off the surface.
Ray mirrored_ray(const Ray& ray, const Hit& hit);

}  // namespace pllit
