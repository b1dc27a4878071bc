#include <algorithm>
#include <array>
#include <cmath>

#include "pllit/sim/places/generators.hpp"
#include "pllit/sim/places/inhabitants.hpp"
#include "pllit/sim/places/walls.hpp"

namespace pllit {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using shapes::at;
using shapes::box;

struct Piece {
  Mesh mesh;
  double depth_m, width_m, height_m;  ///< x, y, z
};

Piece against_wall(Random& random) {
  const double choice = random.uniform();
  if (choice < 0.4) {
    const float width = between(random, 0.8, 1.8), height = between(random, 0.8, 2.2);
    return {shapes::shelf(width, height, random), 0.35, width, height};
  }
  if (choice < 0.55) return {shapes::cabinet({0.4F, 0.7F, 1.6F}, random), 0.45, 0.74, 1.85};
  if (choice < 0.75) return {shapes::desk(random), 0.75, 1.45, 1.2};
  if (choice < 0.9) return {shapes::box_pile(random), 0.62, 0.62, 1.3};
  return {shapes::plant_pot(random), 0.5, 0.5, 1.3};
}

Piece freely_standing(Random& random) {
  const double choice = random.uniform();
  if (choice < 0.5) {
    Mesh group =
        shapes::table({0.8F, 1.5F, 0.74F}, random.uniform() < 0.5 ? Material::dark_wood : Material::light_plastic);
    for (const float side : {-1.0F, 1.0F})
      for (const float y : {-0.4F, 0.4F})
        group.append(at(shapes::chair(Material::fabric), {side * between(random, 0.5, 0.7), y, 0.0F},
                        (side > 0.0F ? 3.14F : 0.0F) + between(random, -0.4, 0.4)));
    for (int i = 0; i < 5; ++i)
      group.append(at(box({0.21F, 0.3F, between(random, 0.005, 0.08)}, {Material::paper}),
                      {between(random, -0.25, 0.25), between(random, -0.6, 0.6), 0.74F}, between(random, 0.0, 3.0)));
    return {group, 2.0, 1.6, 1.0};
  }
  if (choice < 0.8) {
    Mesh group = shapes::desk(random);
    group.append(at(shapes::chair(Material::fabric), {0.55F, between(random, -0.3, 0.3), 0.0F},
                    3.14F + between(random, -0.6, 0.6)));
    return {group, 1.7, 1.5, 1.2};
  }
  if (choice < 0.9) return {shapes::box_pile(random), 0.65, 0.65, 1.3};
  return {shapes::plant_pot(random), 0.55, 0.55, 1.3};
}

void furnish_run(const WallRun& run, FloorPlan& plan, SceneBuilder& scene, Random& random) {
  for (double s = random.uniform(0.1, 0.6); s < run.length_m;) {
    const Piece piece = against_wall(random);
    const double middle_m = s + 0.5 * piece.width_m, off_m = 0.5 * piece.depth_m + 0.02;
    s += piece.width_m + random.uniform(0.05, 0.8);
    if (middle_m + 0.5 * piece.width_m > run.length_m) continue;
    const Vector2d centre = run.from + middle_m * run.along + (off_m + 0.01) * run.normal;
    const Vector2d size = piece.width_m * run.along.cwiseAbs() + piece.depth_m * run.normal.cwiseAbs();
    const AlignedBox2d area = footprint(centre, size.x(), size.y());
    if (!plan.free(area, 0.005)) continue;
    if (scene.add(on_run(piece.mesh, run, middle_m, 0.0, off_m))) plan.take(area, piece.height_m);
  }
}

/// Pictures, switches, trunking, pipes in and on the wall.
void hang_on_run(const WallRun& run, double ceiling_m, SceneBuilder& scene, Random& random) {
  const float length = static_cast<float>(run.length_m);
  const auto put = [&](const Mesh& mesh, double s, double z, double off = 0.0) {
    scene.add(on_run(mesh, run, s, z, off));
  };
  put(box({0.02F, length, 0.08F}, {Material::dark_wood, -0.3F}), 0.5 * run.length_m, 0.0, 0.01);
  if (random.uniform() < 0.4)
    put(box({0.04F, length, 0.06F}, {Material::light_plastic, 0.5F}), 0.5 * run.length_m, random.uniform(2.1, 2.3),
        0.02);
  if (random.uniform() < 0.3) {
    const std::array line{Eigen::Vector3f(0.0F, -0.48F * length, 0.0F), Eigen::Vector3f(0.0F, 0.48F * length, 0.0F)};
    put(shapes::pipe(line, 0.03F, {random.uniform() < 0.5 ? Material::insulation : Material::cold_pipe}),
        0.5 * run.length_m, ceiling_m - 0.2, 0.08);
  }
  for (double s = random.uniform(0.4, 1.2); s < run.length_m - 0.4; s += random.uniform(0.7, 2.0)) {
    const double choice = random.uniform();
    if (choice < 0.3)
      put(box({0.025F, between(random, 0.3, 0.8), between(random, 0.3, 0.7)}, {Material::paper}), s,
          random.uniform(1.2, 1.6), 0.0125);
    else if (choice < 0.5)
      put(box({0.015F, 0.08F, 0.08F}, {Material::light_plastic, 1.0F}), s, random.uniform() < 0.5 ? 0.3 : 1.05, 0.0075);
    else if (choice < 0.8)
      put(shapes::heat_bleed(between(random, 0.15, 0.3), static_cast<float>(ceiling_m), between(random, 0.4, 2.0),
                             run.material),
          s, 0.5 * ceiling_m);
    else
      put(shapes::heat_bleed(between(random, 0.4, 1.2), between(random, 0.3, 0.9), between(random, -1.2, 1.0),
                             run.material),
          s, random.uniform(0.6, 2.0));
  }
}

void furnish_middle(const AlignedBox2d& room, FloorPlan& plan, SceneBuilder& scene, Random& random) {
  const int attempts = 4 + static_cast<int>(2.0 * room.volume());
  for (int i = 0; i < attempts; ++i) {
    const Piece piece = freely_standing(random);
    const bool turned = random.uniform() < 0.5;
    const double size_x = turned ? piece.width_m : piece.depth_m, size_y = turned ? piece.depth_m : piece.width_m;
    const Vector2d centre(random.uniform(room.min().x(), room.max().x()),
                          random.uniform(room.min().y(), room.max().y()));
    const AlignedBox2d area = footprint(centre, size_x, size_y);
    if (!room.contains(area) || !plan.free(area, 0.15)) continue;
    const float yaw = (turned ? 0.5F : 0.0F) * 3.14159265F;
    if (scene.add(at(piece.mesh, {static_cast<float>(centre.x()), static_cast<float>(centre.y()), 0.0F}, yaw)))
      plan.take(area, piece.height_m);
  }
}

void add_floor_and_ceiling(const AlignedBox2d& room, double ceiling_m, SceneBuilder& scene, Random& random) {
  constexpr std::array kFloors{Material::floor_tiles, Material::parquet, Material::carpet, Material::screed};
  const Material floor = kFloors[static_cast<std::size_t>(random.uniform() * kFloors.size())];
  const Eigen::Vector3f x(static_cast<float>(room.sizes().x()), 0.0F, 0.0F),
      y(0.0F, static_cast<float>(room.sizes().y()), 0.0F);
  const Eigen::Vector3f corner(static_cast<float>(room.min().x()), static_cast<float>(room.min().y()), 0.0F);
  const float top = static_cast<float>(ceiling_m);
  scene.add_ground(shapes::panel(corner, x, y, {floor}));
  scene.add(shapes::panel(corner + top * Eigen::Vector3f::UnitZ(), y, x,
                          {random.uniform() < 0.7 ? Material::ceiling_panels : Material::concrete}));
  const int nx = std::max(1, static_cast<int>(x.x() / 2.6F)), ny = std::max(1, static_cast<int>(y.y() / 2.6F));
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      scene.add(at(shapes::ceiling_lamp(1.2F),
                   {corner.x() + x.x() * (static_cast<float>(i) + 0.5F) / static_cast<float>(nx),
                    corner.y() + y.y() * (static_cast<float>(j) + 0.5F) / static_cast<float>(ny), top}));
  if (random.uniform() < 0.5) {
    const float at_y = corner.y() + between(random, 0.15, 0.85) * y.y(), z = top - 0.22F;
    const std::array line{Eigen::Vector3f(corner.x() + 0.2F, at_y, z),
                          Eigen::Vector3f(corner.x() + x.x() - 0.2F, at_y, z)};
    scene.add(random.uniform() < 0.5 ? shapes::duct(line, 0.3F)
                                     : shapes::pipe(line, 0.05F, {Material::insulation, between(random, -4.0, 6.0)}));
  }
}

}  // namespace

Expected<PlaceParts> make_room(const PlaceConfig& config) {
  Random random(config.seed, 10);
  const Site site = site_on_flat_ground(config, random.uniform(0.0, 1.5));
  FloorPlan plan(site);
  SceneBuilder scene(site);
  const auto margin = [&] { return site.clearance_m + random.uniform(1.6, 3.2); };
  const Vector2d low(site.bounds_P.min().x() - margin(), site.bounds_P.min().y() - margin());
  const Vector2d high(site.bounds_P.max().x() + margin(), site.bounds_P.max().y() + margin());
  const double ceiling_m = std::max(random.uniform(2.7, 3.3), site.bounds_P.max().z() + site.clearance_m + 0.75);
  const Floor floor = add_floor_walls({low, high}, ceiling_m, plan, scene, random);

  auto actors = add_findings(config, floor.box, ceiling_m, plan, scene);
  if (!actors) return std::unexpected(actors.error());
  for (const WallRun& run : floor.runs) {
    hang_on_run(run, ceiling_m, scene, random);
    furnish_run(run, plan, scene, random);
  }
  for (const AlignedBox2d& room : floor.rooms) {
    add_floor_and_ceiling(room, ceiling_m, scene, random);
    furnish_middle(room, plan, scene, random);
  }
  for (Actor& walker : walkers_inside(config, floor.box, plan)) actors->push_back(std::move(walker));
  return indoors(config, std::move(*actors), scene);
}

}  // namespace pllit
