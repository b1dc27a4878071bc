#include <algorithm>
#include <array>

#include "pllit/sim/places/corridor_shell.hpp"
#include "pllit/sim/places/generators.hpp"
#include "pllit/sim/places/inhabitants.hpp"

namespace pllit {
namespace {

using Eigen::Vector2d;

constexpr double kBeyond_m = 130.0;  // the end walls are beyond a LiDAR's reach from everywhere on the path

/// Boxes and shelves at the far ends only.
void furnish_ends(const CorridorShell& shell, SceneBuilder& scene, Random& random) {
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
  CorridorShell shell{};
  shell.from_x = static_cast<float>(site.bounds_P.min().x() - kBeyond_m);
  shell.to_x = static_cast<float>(site.bounds_P.max().x() + kBeyond_m);
  shell.low_y = static_cast<float>(site.bounds_P.min().y() - aside_m);
  shell.high_y = static_cast<float>(site.bounds_P.max().y() + aside_m);
  shell.height =
      static_cast<float>(std::max(random.uniform(2.6, 3.0), site.bounds_P.max().z() + site.clearance_m + 0.3));
  add_corridor(shell, config.bare ? Relief::bare : Relief::some, scene, random);
  furnish_ends(shell, scene, random);

  const Eigen::AlignedBox2d box(Vector2d(shell.from_x, shell.low_y), Vector2d(shell.to_x, shell.high_y));
  return indoors(config, walkers_inside(config, box, plan), scene);
}

}  // namespace pllit
