#include "pllit/sim/places/corridor_shell.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pllit {
namespace {

using Eigen::Vector3f;
using shapes::box;
using shapes::panel;

constexpr float kPiece_m = 6.0F;  // surfaces are cut into pieces so that tiles stay small
constexpr float kDoorWidth_m = 1.1F, kDoorHeight_m = 2.15F;

/// Adds pieces given about z = 0 on the corridor's floor.
class Fitter {
 public:
  Fitter(const CorridorShell& shell, SceneBuilder& scene) : shell_(shell), scene_(scene) {}

  void add(const Mesh& piece) { scene_.add(shapes::at(piece, {0.0F, 0.0F, shell_.floor_z})); }
  void add_ground(const Mesh& piece) { scene_.add_ground(shapes::at(piece, {0.0F, 0.0F, shell_.floor_z})); }
  /// Against a side wall (-1: at low_y, +1: at high_y), the piece's +x into the corridor.
  void add_on_wall(const Mesh& piece, float side, float x, float z) {
    const float y = side < 0.0F ? shell_.low_y : shell_.high_y;
    add(shapes::at(piece, {x, y, z}, side < 0.0F ? 1.5707963F : -1.5707963F));
  }

 private:
  const CorridorShell& shell_;
  SceneBuilder& scene_;
};

struct Door {
  float x;      ///< of its middle
  float depth;  ///< 0: flush
  float warmer_K;
};

std::vector<Door> doors_along(const CorridorShell& shell, Relief relief, Random& random) {
  std::vector<Door> doors;
  for (float x = shell.from_x + static_cast<float>(random.uniform(2.0, 9.0)); x < shell.to_x - 2.0F;
       x += static_cast<float>(random.uniform(10.0, 20.0))) {
    const double depth_m = random.uniform(0.05, 0.15);
    doors.push_back({x, relief == Relief::bare ? 0.0F : static_cast<float>(depth_m),
                     static_cast<float>(random.uniform(-0.8, 0.8))});
  }
  return doors;
}

/// A piece of wall with a recessed door, as wide as the door and half a metre to either side.
Mesh wall_with_door(const Door& door, float height) {
  const float half = 0.5F * kDoorWidth_m;
  const std::array holes{shapes::Hole(-half, 0.0F, half, kDoorHeight_m)};
  Mesh mesh = shapes::wall_with_holes(kDoorWidth_m + 1.0F, height, holes, door.depth, {Material::plaster});
  mesh.append(panel({-door.depth, -half, 0.0F}, {0.0F, 2.0F * half, 0.0F}, {0.0F, 0.0F, kDoorHeight_m},
                    {Material::door_leaf, door.warmer_K}));
  const shapes::Finish frame{Material::door_frame, 0.5F * door.warmer_K};
  for (const float y : {-half, half})
    mesh.append(shapes::at(box({0.03F, 0.07F, kDoorHeight_m + 0.035F}, frame), {0.0F, y, 0.0F}));
  mesh.append(shapes::at(box({0.03F, kDoorWidth_m + 0.07F, 0.07F}, frame), {0.0F, 0.0F, kDoorHeight_m}));
  mesh.append(shapes::at(box({0.05F, 0.12F, 0.03F}, {Material::bare_metal}), {0.025F - door.depth, 0.4F, 1.05F}));
  return mesh;
}

/// A leaf and its frame painted on the wall, so to speak.
Mesh flush_door(const Door& door) {
  const auto patch = [](float off, float width, float height, shapes::Finish finish) {
    return panel({off, -0.5F * width, 0.0F}, {0.0F, width, 0.0F}, {0.0F, 0.0F, height}, finish);
  };
  Mesh mesh = patch(0.002F, kDoorWidth_m, kDoorHeight_m, {Material::door_frame, 0.5F * door.warmer_K});
  mesh.append(patch(0.004F, kDoorWidth_m - 0.12F, kDoorHeight_m - 0.06F, {Material::door_leaf, door.warmer_K}));
  return mesh;
}

/// With its skirting.
void add_plain_wall(Fitter& fit, float side, float from_x, float to_x, float height) {
  const int pieces = std::max(1, static_cast<int>(std::ceil((to_x - from_x) / kPiece_m)));
  const float step = (to_x - from_x) / static_cast<float>(pieces);
  const Vector3f y(0.0F, step, 0.0F);
  for (int i = 0; i < pieces; ++i) {
    Mesh piece = panel({0.0F, -0.5F * step, 0.0F}, y, {0.0F, 0.0F, height}, {Material::plaster});
    piece.append(panel({0.008F, -0.5F * step, 0.0F}, y, {0.0F, 0.0F, 0.1F}, {Material::dark_wood}));
    fit.add_on_wall(piece, side, from_x + (static_cast<float>(i) + 0.5F) * step, 0.0F);
  }
}

void add_side_wall(const CorridorShell& shell, float side, Relief relief, Fitter& fit, Random& random) {
  const float half = 0.5F * kDoorWidth_m + 0.5F;
  float done_x = shell.from_x;
  for (const Door& door : doors_along(shell, relief, random)) {
    if (relief == Relief::bare) {
      fit.add_on_wall(flush_door(door), side, door.x, 0.0F);
      continue;
    }
    add_plain_wall(fit, side, done_x, door.x - half, shell.height);
    fit.add_on_wall(wall_with_door(door, shell.height), side, door.x, 0.0F);
    done_x = door.x + half;
  }
  add_plain_wall(fit, side, done_x, shell.to_x, shell.height);
}

void add_floor_ceiling_and_ends(const CorridorShell& shell, Fitter& fit) {
  const float w = shell.high_y - shell.low_y;
  const int pieces = std::max(1, static_cast<int>((shell.to_x - shell.from_x) / kPiece_m));
  const float step = (shell.to_x - shell.from_x) / static_cast<float>(pieces);
  const Vector3f x(step, 0.0F, 0.0F), y(0.0F, w, 0.0F), z(0.0F, 0.0F, shell.height);
  for (int i = 0; i < pieces; ++i) {
    const Vector3f corner(shell.from_x + step * static_cast<float>(i), shell.low_y, 0.0F);
    fit.add_ground(panel(corner, x, y, {Material::floor_tiles}));
    fit.add(panel(corner + z, y, x, {Material::ceiling_panels}));
  }
  if (!shell.open_from) fit.add(panel({shell.from_x, shell.low_y, 0.0F}, y, z, {Material::plaster}));
  if (!shell.open_to) fit.add(panel({shell.to_x, shell.low_y, 0.0F}, y, z, {Material::plaster}));
}

/// Trunking and, where no door is in its way, a hand rail on both sides, the whole length: nothing on them tells one
/// metre from the next.
void add_rails(const CorridorShell& shell, Relief relief, Fitter& fit, Random& random) {
  const float rail_z = static_cast<float>(random.uniform(0.85, 0.95)), trunk_z = shell.height - 0.15F;
  const float step = (shell.to_x - shell.from_x) / std::ceil((shell.to_x - shell.from_x) / kPiece_m);
  const auto add_bar = [&](float x, float y, float z, float radius, Material material) {
    fit.add(shapes::tube(std::array{Vector3f(x, y, z), Vector3f(x + step, y, z)}, radius, 8, {material}));
  };
  for (float x = shell.from_x; x < shell.to_x - 0.5F * step; x += step) {
    add_bar(x, shell.low_y + 0.12F, trunk_z, 0.05F, Material::insulation);
    if (relief != Relief::bare) continue;
    add_bar(x, shell.low_y + 0.05F, rail_z, 0.025F, Material::wood);
    add_bar(x, shell.high_y - 0.05F, rail_z, 0.025F, Material::wood);
  }
}

/// What a thermal camera sees where a LiDAR sees nothing: pipes and damp in the walls, lamps flush with the ceiling.
void add_flush_details(const CorridorShell& shell, Fitter& fit, Random& random) {
  for (const float side : {-1.0F, 1.0F})
    for (float x = shell.from_x + 2.0F; x < shell.to_x - 2.0F; x += static_cast<float>(random.uniform(1.5, 5.0))) {
      const float peak_K = static_cast<float>(random.uniform(0.4, 2.0));
      if (random.uniform() < 0.5)
        fit.add_on_wall(shapes::heat_bleed(0.25F, shell.height, peak_K, Material::plaster), side, x,
                        0.5F * shell.height);
      else
        fit.add_on_wall(
            shapes::heat_bleed(static_cast<float>(random.uniform(0.3, 1.2)), 0.6F, peak_K - 1.2F, Material::plaster),
            side, x, static_cast<float>(random.uniform(0.5, 2.0)));
    }
  for (float x = shell.from_x + 1.5F; x < shell.to_x - 1.5F; x += 3.0F) {
    const float y = 0.5F * (shell.low_y + shell.high_y) - 0.15F;
    fit.add(panel({x, y, shell.height - 0.002F}, {0.0F, 0.3F, 0.0F}, {1.2F, 0.0F, 0.0F},
                  {Material::lamp, static_cast<float>(random.uniform(-2.0, 2.0))}));
  }
}

/// Hose cabinets and boards that stand out from the walls by a hand's breadth or less.
void add_wall_boxes(const CorridorShell& shell, Fitter& fit, Random& random) {
  for (const float side : {-1.0F, 1.0F})
    for (float x = shell.from_x + static_cast<float>(random.uniform(5.0, 25.0)); x < shell.to_x - 1.0F;
         x += static_cast<float>(random.uniform(20.0, 40.0))) {
      const bool hose = random.uniform() < 0.5;
      const Vector3f size = hose ? Vector3f(0.12F, 0.6F, 0.75F) : Vector3f(0.03F, 1.2F, 0.9F);
      const Material material = hose ? Material::painted_metal : Material::paper;
      fit.add_on_wall(shapes::at(box(size, {material}), {0.5F * size.x(), 0.0F, 0.0F}), side, x, 1.0F);
    }
}

}  // namespace

void add_corridor(const CorridorShell& shell, Relief relief, SceneBuilder& scene, Random& random) {
  Fitter fit(shell, scene);
  add_floor_ceiling_and_ends(shell, fit);
  for (const float side : {-1.0F, 1.0F}) add_side_wall(shell, side, relief, fit, random);
  add_rails(shell, relief, fit, random);
  add_flush_details(shell, fit, random);
  if (relief != Relief::bare) add_wall_boxes(shell, fit, random);
}

}  // namespace pllit
