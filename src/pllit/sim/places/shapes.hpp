// Shapes that worlds are furnished with. Each is a mesh in a frame of its own: z up, standing on z = 0 around the
// origin unless stated otherwise, its front towards +x. Lengths in metres.
#pragma once

#include <Eigen/Geometry>
#include <numbers>
#include <span>

#include "pllit/sim/places/surfaces.hpp"
#include "pllit/sim/random.hpp"

namespace pllit::shapes {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;

/// What a piece is made of, and how much warmer it is than others of its kind.
struct Finish {
  Material material;
  float warmer_K = 0.0F;
};

Mesh moved(Mesh mesh, const Eigen::Isometry3f& T_to_from);
/// Turned by yaw about z, then put at p.
Mesh at(Mesh mesh, const Vector3f& p, float yaw_rad = 0.0F);

// Basic shapes (shapes.cpp)

/// The parallelogram from `corner` along u and v, cut into nu by nv cells; its normal is u x v.
Mesh panel(const Vector3f& corner, const Vector3f& u, const Vector3f& v, Finish finish, int nu = 1, int nv = 1);
Mesh box(const Vector3f& size, Finish finish);
/// Turns a profile of (radius, height), from bottom to top, about z: cylinders, cones, spheres, vessels.
Mesh lathe(std::span<const Vector2f> profile, int sides, Finish finish);
Mesh cylinder(float radius, float height, int sides, Finish finish);
/// Around its centre.
Mesh sphere(float radius, int sides, Finish finish);
/// A round bar along a polyline; corners are mitred.
Mesh tube(std::span<const Vector3f> line, float radius, int sides, Finish finish);
/// A tube with its corners rounded into elbows of a bend radius twice the pipe's, and a flange at every end and elbow.
Mesh pipe(std::span<const Vector3f> line, float radius, Finish finish);
/// A cable that hangs between two points, lower in the middle by sag.
Mesh cable(const Vector3f& from, const Vector3f& to, float sag, float radius);
/// A wall of the given width (along y, centred) and height whose front is x = 0, with rectangular holes {y0, z0, y1,
/// z1} (not overlapping) and reveals of the given depth towards -x.
using Hole = Eigen::Vector4f;
Mesh wall_with_holes(float width, float height, std::span<const Hole> holes, float depth, Finish finish);
/// Part of a wall (in its plane, x = 0, centred on the origin in y and z) that something behind it warms by peak_K in
/// the middle: cells of equal finish 2 mm in front of it whose warmth falls off as a bell curve. An edge for a thermal
/// camera, nothing for a LiDAR.
Mesh heat_bleed(float width, float height, float peak_K, Material wall);

// Furniture (furniture.cpp)

Mesh table(const Vector3f& size, Material top);
Mesh chair(Material seat);
Mesh desk(Random& random);  ///< 1.4 x 0.7: table, screen, keyboard, lamp, papers
Mesh shelf(float width, float height,
           Random& random);  ///< 0.35 deep, filled with books and boxes; its back is at x = -0.175
Mesh radiator(float width, float height, float warmer_K);  ///< ribs; its back is at x = -0.06
Mesh window(float width, float height);                    ///< frame, mullion and glass in the plane x = 0, from z = 0
Mesh door(float width, float height);                      ///< leaf with handle in its frame, 6 cm thick
Mesh plant_pot(Random& random);
Mesh box_pile(Random& random);
Mesh ceiling_lamp(float length);  ///< hangs from z = 0 downwards, along y
Mesh kettle();
Mesh toolbox();

// Machines (machines.cpp)

Mesh cabinet(const Vector3f& size, Random& random);     ///< door seams, vents, handle, cable entry
Mesh motor(float length, float warmer_K);               ///< ribbed, on feet, axis along y
Mesh pump_set(Random& random);                          ///< motor, coupling and pump on a plinth, 1.6 along y
Mesh tank(float radius, float height, float warmer_K);  ///< on legs, with dished ends, manhole, nozzles and ladder
Mesh flange(float radius);                              ///< a valve body on a vertical pipe of that radius, centred
Mesh duct(std::span<const Vector3f> line, float side);  ///< rectangular, with seams
Mesh i_beam(float length, float height);                ///< along y, centred
Mesh railing(std::span<const Vector3f> foot_line);      ///< posts, knee and hand rail, 1.0 high

// Outdoors (outdoors.cpp)

Mesh tree(float height, int leaf_count, Random& random);
Mesh bush(float height, int leaf_count, Random& random);
Mesh car(Random& random);        ///< 4.3 x 1.8, nose towards +x
Mesh person(Random& random);     ///< 1.6 to 1.9 tall
Mesh street_lamp(float height);  ///< arm towards +x
Mesh sign(Random& random);
Mesh bin(Random& random);
Mesh fence(float length, Random& random);  ///< along y, centred
/// Front (at x = 0, towards +x) and body of a house, centred in y.
struct House {
  float width = 12.0F, storey = 3.1F, depth = 8.0F;
  int storeys = 3;
  Material wall = Material::facade_plaster;
};
Mesh house(const House& house, Random& random);

}  // namespace pllit::shapes
