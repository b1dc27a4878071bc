// Walls of a floor around a path: a rectangle cut into rooms, open where the path passes.
#pragma once

#include <vector>

#include "pllit/sim/places/scene.hpp"

namespace pllit {

/// A stretch of solid wall, seen from one side.
struct WallRun {
  Eigen::Vector2d from, along;  ///< along: unit
  double length_m;
  Eigen::Vector2d normal;  ///< unit, into the room
  Material material;
  bool outer;
};

struct Floor {
  Eigen::AlignedBox2d box;
  double ceiling_m;
  std::vector<Eigen::AlignedBox2d> rooms;
  std::vector<WallRun> runs;
};

/// Puts a mesh against a run: s metres along it, z up, `off` in front of it, its +x into the room.
Mesh on_run(const Mesh& mesh, const WallRun& run, double s, double z, double off = 0.0);

/// Cuts the box into rooms of 3 to 7 m, adds walls, door frames and lintels, and takes the walls' footprints.
Floor add_floor_walls(const Eigen::AlignedBox2d& box, double ceiling_m, FloorPlan& plan, SceneBuilder& scene,
                      Random& random);

}  // namespace pllit
