// What moves, heats up, or is to be found.
#pragma once

#include <vector>

#include "pllit/sim/places/scene.hpp"

namespace pllit {

/// Puts findings and distractors on spots inside `box_P` from where the path is in sight, with what they stand on;
/// takes their footprints and the lines of sight. Walls must have been taken before, furniture should be placed after.
Expected<std::vector<Actor>> add_findings(const PlaceConfig& config, const Eigen::AlignedBox2d& box_P, double ceiling_m,
                                          FloorPlan& plan, SceneBuilder& scene);

/// People who walk to and fro on free straight lines inside box_P, 1.5 m or more off the path. All furniture must have
/// been taken.
std::vector<Actor> walkers_inside(const PlaceConfig& config, const Eigen::AlignedBox2d& box_P, const FloorPlan& plan);

/// Moves an actor to and fro along a line in P at a steady speed until the end of the motion, starting at a share of
/// the way.
Actor pacing(std::string name, Mesh mesh_O, const std::vector<Vector3d>& line_P, double speed_mps, double start_share,
             double until_s, const SE3& T_W_P);

}  // namespace pllit
