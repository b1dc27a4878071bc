// What worlds are made of: triangles whose surfaces say how every sensor sees them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pllit/geometry/lie.hpp"

namespace pllit {

/// A pattern over a surface as a function of the place in the mesh's own frame: mean 0, amplitude 1.
struct Texture {
  enum class Kind { plain, clouds, bricks, tiles, planks, speckle, stains, wires };
  Kind kind = Kind::plain;
  float scale_m = 1.0F;   ///< size of the largest feature
  float contrast = 0.0F;  ///< amplitude in the unit of what it varies
  std::uint32_t seed = 0;
};

/// How one kind of surface answers light, heat and laser.
struct Surface {
  std::string name;           ///< for people: "brick wall", "radiator"
  float reflectivity = 0.5F;  ///< at the LiDAR's 905 nm, 0 to 1
  float albedo = 0.5F;        ///< visible, grey, 0 to 1
  float emissivity = 0.93F;   ///< 8 to 14 um
  float mirror = 0.0F;        ///< share of what is not emitted (or of the light) that is reflected as by a mirror
  float glow = 0.0F;          ///< visible light of its own (lamps), in units of a white surface in full light
  float excess_K = 0.0F;      ///< above the air's temperature when the simulation starts
  float follows_air = 0.2F;   ///< share of a change of the air's temperature that it takes on within minutes
  float sun_K = 0.0F;         ///< more where the sun meets it at a right angle
  float sees_sky = 0.0F;      ///< share of its hemisphere that is sky: it cools, and reflects a cold sky
  Texture paint;              ///< varies albedo (and, a third as much, reflectivity)
  Texture heat;               ///< varies temperature, in K
};

/// Triangles in a frame of their own. Normals are the right-handed ones of the corner order; surfaces are visible from
/// both sides. The three arrays of triangles have equal length.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> surface;  ///< index into Place::surfaces()
  std::vector<float> warmer_K;         ///< added to the surface's excess_K: no two motors are equally warm

  void append(const Mesh& other);
};

/// A mesh of its own that moves, appears, vanishes or heats up: people, cars, and whatever an inspector should find.
struct Actor {
  struct Waypoint {
    double at_s = 0.0;  ///< since the start of the motion
    SE3 T_W_O = SE3::Identity();
  };
  struct Heating {
    double at_s = 0.0;
    float by_K = 0.0F;    ///< negative where it cools
    double over_s = 1.0;  ///< time constant of the approach
  };
  std::string name;  ///< "kettle", "person"
  Mesh mesh_O;
  std::vector<Waypoint> path;  ///< in order of time, at least one; held before the first and after the last
  double appears_s = 0.0, vanishes_s = 1e18;
  std::vector<Heating> heating;
  bool finding = false;  ///< an inspector should be told

  /// Where it is at t_s: between waypoints the position changes evenly and the rotation turns about one axis.
  SE3 pose(double t_s) const;
  bool present(double t_s) const { return t_s >= appears_s && t_s < vanishes_s; }
};

}  // namespace pllit
