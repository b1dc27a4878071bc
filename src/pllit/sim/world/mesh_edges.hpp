// Straight edges of meshes: where surfaces end, bend, or change what they are made of.
#pragma once

#include <vector>

#include "pllit/sim/world/mesh.hpp"

namespace pllit {

/// From one end to the other, in the mesh's frame.
struct MeshEdge {
  Eigen::Vector3f from, to;
};

/// All edges of triangles at which a surface ends, bends by more than 3 degrees, or changes its material or warmth.
/// Vertices closer than about a millimetre are one, and edges that continue each other within half a degree are joined.
/// Some are no edges to the eye, as where one panel ends on the middle of another: visible_edges() sorts those out.
std::vector<MeshEdge> straight_edges(const Mesh& mesh);

}  // namespace pllit
