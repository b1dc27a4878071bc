// The straight edges of a place that a camera sees, as truth for line detectors.
#pragma once

#include <map>
#include <vector>

#include "pllit/sim/camera/expose.hpp"
#include "pllit/sim/world/mesh_edges.hpp"

namespace pllit {

/// The visible part of a straight edge: one that is hidden in its middle gives two.
struct ImageEdge {
  enum class Kind {
    occlusion,  ///< one side lies behind the other
    crease,     ///< the surface bends by more than 20 degrees
    border      ///< material or warmth changes within a plane
  };
  Kind kind = Kind::occlusion;
  Vector3d from_W, to_W;
  /// Distorted pixels, at least two: bent where distortion bends the edge, within 0.25 px of it between the points.
  std::vector<Eigen::Vector2d> line_px;
  float contrast = 0.0F;  ///< |mean difference| of what is received from 1.5 px to either side, in the unit of Shade

  double length_px() const;
};

/// Edges of a place's meshes, kept for the tiles around the last position. Textures, shadows and mirror images are no
/// edges here, nor are outlines of round things finer than their meshes' corners.
class PlaceEdges {
 public:
  /// The place must outlive it. reach_m: how far from the camera tiles are searched for edges.
  PlaceEdges(const Place& place, double reach_m);

  struct View {
    Camera camera;
    SE3 T_W_C;              ///< in the middle of the exposure (for a bolometer, one time constant before readout)
    double actors_s = 0.0;  ///< since the start: when actors are where the caster has put them
    double least_px = 10.0;
  };
  /// Those of at least least_px in the image, longest first, without doubles. An edge is seen where rays 1.5 px to
  /// either side meet a surface that it lies in, and differ as its kind says. The caster has been moved to the camera.
  std::vector<ImageEdge> visible(const View& view, const RayCaster& caster, const Shade& shade, Arena& arena);

 private:
  void gather_tiles(const Vector3d& p_W);

  struct TileEdges {
    Vector3d origin_W;
    std::vector<MeshEdge> edges;
  };
  const Place& place_;
  double reach_m_;
  std::map<std::uint32_t, TileEdges> tiles_;
  std::vector<std::vector<MeshEdge>> actors_O_;
};

}  // namespace pllit
