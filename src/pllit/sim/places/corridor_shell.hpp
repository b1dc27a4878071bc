// What a corridor consists of, wherever it runs.
#pragma once

#include "pllit/sim/places/scene.hpp"

namespace pllit {

/// A box in P, long in x.
struct CorridorShell {
  float from_x, to_x, low_y, high_y;
  float height;
  float floor_z = 0.0F;
  bool open_from = false, open_to = false;  ///< without a wall at that end
};

enum class Relief {
  bare,  ///< doors flush with the walls: nothing tells a LiDAR one metre from the next
  some   ///< doors 5 to 15 cm deep in the walls every 10 to 20 m, boxes on the walls here and there
};

/// Floor, ceiling, walls, rails, doors, lamps, and what only a thermal camera sees in the walls.
void add_corridor(const CorridorShell& shell, Relief relief, SceneBuilder& scene, Random& random);

}  // namespace pllit
