#include <algorithm>
#include <array>
#include <cmath>

#include "pllit/sim/places/generators.hpp"
#include "pllit/sim/places/inhabitants.hpp"

namespace pllit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;
using shapes::panel;

constexpr double kBeyond_m = 130.0;  // the end walls are beyond a LiDAR's reach from everywhere on the path
constexpr double kPiece_m = 6.0;     // surfaces are cut into pieces so that tiles stay small

struct Shell {
  float from_x, to_x, low_y, high_y, height;
};

/// A patch in the plane of a side wall, 2 mm in front of it: s along x, z up. side: -1 the wall at low_y, +1 at high_y.
Mesh wall_patch(const Shell& shell, float side, float x, float z, float width, float height, shapes::Finish finish) {
  const float y = side < 0.0F ? shell.low_y + 0.002F : shell.high_y - 0.002F;
  return panel({x, y, z}, {side < 0.0F ? -width : width, 0.0F, 0.0F}, {0.0F, 0.0F, height}, finish);
}

Mesh bleed_on_wall(const Shell& shell, float side, float x, float z, float width, float height, float peak_K) {
  const float y = side < 0.0F ? shell.low_y : shell.high_y;
  return shapes::at(shapes::heat_bleed(width, height, peak_K, Material::plaster), {x, y, z},
                    side < 0.0F ? 1.5707963F : -1.5707963F);
}

void add_shell(const Shell& shell, SceneBuilder& scene) {
  const float w = shell.high_y - shell.low_y;
  const int pieces = std::max(1, static_cast<int>((shell.to_x - shell.from_x) / static_cast<float>(kPiece_m)));
  const float step = (shell.to_x - shell.from_x) / static_cast<float>(pieces);
  const Vector3f x(step, 0.0F, 0.0F), y(0.0F, w, 0.0F), z(0.0F, 0.0F, shell.height);
  for (int i = 0; i < pieces; ++i) {
    const Vector3f corner(shell.from_x + step * static_cast<float>(i), shell.low_y, 0.0F);
    scene.add_ground(panel(corner, x, y, {Material::floor_tiles}));
    scene.add(panel(corner + z, y, x, {Material::ceiling_panels}));
    scene.add(panel(corner, z, x, {Material::plaster}));
    scene.add(panel(corner + y, x, z, {Material::plaster}));
  }
  for (const float end : {shell.from_x, shell.to_x})
    scene.add(panel({end, shell.low_y, 0.0F}, y, z, {Material::plaster}));
}

/// Rails and trunking that run the whole length: nothing on them tells one metre from the next.
void add_rails(const Shell& shell, SceneBuilder& scene, Random& random) {
  const float rail_z = static_cast<float>(random.uniform(0.85, 0.95)), trunk_z = shell.height - 0.35F;
  const float step =
      (shell.to_x - shell.from_x) / std::ceil((shell.to_x - shell.from_x) / static_cast<float>(kPiece_m));
  for (float x = shell.from_x; x < shell.to_x - 0.5F * step; x += step) {
    for (const float side : {-1.0F, 1.0F}) {
      const float wall_y = side < 0.0F ? shell.low_y : shell.high_y;
      const float y = wall_y - side * 0.05F;
      scene.add(
          shapes::tube(std::array{Vector3f(x, y, rail_z), Vector3f(x + step, y, rail_z)}, 0.025F, 8, {Material::wood}));
      const Mesh skirting =
          wall_patch(shell, side, side < 0.0F ? x + step : x, 0.0F, step, 0.1F, {Material::dark_wood});
      scene.add(shapes::at(skirting, {0.0F, -side * 0.006F, 0.0F}));
    }
    const float y = shell.low_y + 0.12F;
    scene.add(shapes::tube(std::array{Vector3f(x, y, trunk_z), Vector3f(x + step, y, trunk_z)}, 0.05F, 8,
                           {Material::insulation}));
  }
}

/// What a thermal camera sees where a LiDAR sees nothing: doors flush with the wall, their colder frames, pipes and
/// damp in the wall.
void add_flush_details(const Shell& shell, SceneBuilder& scene, Random& random) {
  const auto signed_x = [](float side, float x, float width) { return side < 0.0F ? x + width : x; };
  for (const float side : {-1.0F, 1.0F}) {
    for (float x = shell.from_x + static_cast<float>(random.uniform(2.0, 9.0)); x < shell.to_x - 3.0F;
         x += static_cast<float>(random.uniform(7.0, 19.0))) {
      const float warmer_K = static_cast<float>(random.uniform(-0.8, 0.8));
      scene.add(
          wall_patch(shell, side, signed_x(side, x, 1.1F), 0.0F, 1.1F, 2.15F, {Material::door_frame, 0.5F * warmer_K}));
      Mesh leaf = wall_patch(shell, side, signed_x(side, x + 0.06F, 0.98F), 0.0F, 0.98F, 2.09F,
                             {Material::door_leaf, warmer_K});
      scene.add(shapes::at(leaf, {0.0F, -side * 0.002F, 0.0F}));
    }
    for (float x = shell.from_x + 2.0F; x < shell.to_x - 2.0F; x += static_cast<float>(random.uniform(1.5, 5.0))) {
      const float peak_K = static_cast<float>(random.uniform(0.4, 2.0));
      if (random.uniform() < 0.5)
        scene.add(bleed_on_wall(shell, side, x, 0.5F * shell.height, 0.25F, shell.height, peak_K));
      else
        scene.add(bleed_on_wall(shell, side, x, static_cast<float>(random.uniform(0.5, 2.0)),
                                static_cast<float>(random.uniform(0.3, 1.2)), 0.6F, peak_K - 1.2F));
    }
  }
  for (float x = shell.from_x + 1.5F; x < shell.to_x - 1.5F; x += 3.0F) {  // lamps flush with the ceiling
    const float y = 0.5F * (shell.low_y + shell.high_y) - 0.15F;
    scene.add(panel({x, y, shell.height - 0.002F}, {0.0F, 0.3F, 0.0F}, {1.2F, 0.0F, 0.0F},
                    {Material::lamp, static_cast<float>(random.uniform(-2.0, 2.0))}));
  }
}

/// Boxes and shelves at the far ends only.
void furnish_ends(const Shell& shell, SceneBuilder& scene, Random& random) {
  for (const float end : {shell.from_x + 1.0F, shell.to_x - 1.0F})
    for (const float y : {shell.low_y + 0.4F, shell.high_y - 0.4F})
      scene.add(shapes::at(shapes::box_pile(random), {end, y, 0.0F}));
}

}  // namespace

Expected<PlaceParts> make_corridor(const PlaceConfig& config) {
  Random random(config.seed, 20);
  const Site site = site_on_flat_ground(config, main_yaw_rad(config.path_W));
  FloorPlan plan(site);
  SceneBuilder scene(site);
  const double aside_m = site.clearance_m + random.uniform(0.35, 0.6);
  Shell shell{};
  shell.from_x = static_cast<float>(site.bounds_P.min().x() - kBeyond_m);
  shell.to_x = static_cast<float>(site.bounds_P.max().x() + kBeyond_m);
  shell.low_y = static_cast<float>(site.bounds_P.min().y() - aside_m);
  shell.high_y = static_cast<float>(site.bounds_P.max().y() + aside_m);
  shell.height =
      static_cast<float>(std::max(random.uniform(2.6, 3.0), site.bounds_P.max().z() + site.clearance_m + 0.3));
  add_shell(shell, scene);
  add_rails(shell, scene, random);
  add_flush_details(shell, scene, random);
  furnish_ends(shell, scene, random);

  const Eigen::AlignedBox2d box(Vector2d(shell.from_x, shell.low_y), Vector2d(shell.to_x, shell.high_y));
  return indoors(config, walkers_inside(config, box, plan), scene);
}

}  // namespace pllit
