// Places to simulate in, each with the lane that is kept free for walking.
#pragma once

#include <cstdint>

#include "pllit/sim/boxes/planes_world.hpp"
#include "pllit/sim/motion/walks.hpp"

namespace pllit {

struct Scene {
  PlanesWorld world;
  Lane lane;
};

/// A room of about 18 x 12 x 4 m with shelves, tables and stub walls along its walls, and a partition, a table and a
/// ramp in its middle; the seed chooses sizes and places.
Scene room(std::uint64_t seed);

/// Two walls, floor and ceiling, 3 m wide and high, along x from far before the origin to far beyond length_m: farther
/// than a LiDAR sees. Nothing in it tells where along x one is.
Scene corridor(double length_m);

/// A street of about 200 m along x on slightly inclined ground, between buildings, with parked vehicles.
Scene outdoor(std::uint64_t seed);

}  // namespace pllit
