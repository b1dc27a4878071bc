#include <algorithm>
#include <array>
#include <cmath>

#include "pllit/sim/places/generators.hpp"
#include "pllit/sim/places/inhabitants.hpp"

namespace pllit {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Eigen::Vector3f;
using shapes::at;
using shapes::box;
using shapes::panel;

constexpr double kBay_m = 6.0;

Vector3f point(const Vector2d& p, double z) { return Eigen::Vector3d(p.x(), p.y(), z).cast<float>(); }

struct Hall {
  AlignedBox2d box;
  double height_m;
};

/// Puts a machine where it fits.
bool put(const Mesh& mesh, const Vector2d& centre, double size_x, double size_y, double height_m, FloorPlan& plan,
         SceneBuilder& scene) {
  const AlignedBox2d area = footprint(centre, size_x, size_y);
  if (!plan.free(area, 0.05) || !scene.add(at(mesh, point(centre, 0.0)))) return false;
  plan.take(area, height_m);
  return true;
}

void add_shell(const Hall& hall, SceneBuilder& scene, Random& random) {
  const Vector2d a = hall.box.min(), c = hall.box.max(), b(c.x(), a.y()), d(a.x(), c.y());
  const float height = static_cast<float>(hall.height_m);
  struct Side {
    Vector2d from, to;
    float yaw;
  };
  for (const Side& side : {Side{a, b, 1.5707963F}, Side{b, c, 3.1415927F}, Side{c, d, -1.5707963F}, Side{d, a, 0.0F}}) {
    const Vector2d along = (side.to - side.from).normalized();
    const double length_m = (side.to - side.from).norm();
    const int bays = std::max(1, static_cast<int>(length_m / kBay_m));
    const float width = static_cast<float>(length_m / bays);
    for (int i = 0; i < bays; ++i) {
      const Vector2d middle = side.from + along * ((i + 0.5) * static_cast<double>(width));
      const std::array holes{shapes::Hole(-0.35F * width, height - 2.2F, 0.35F * width, height - 0.9F)};
      Mesh bay =
          shapes::wall_with_holes(width, height, holes, 0.2F, {i % 2 ? Material::concrete : Material::brick_wall});
      bay.append(at(shapes::window(0.7F * width, 1.3F), {-0.1F, 0.0F, height - 2.2F}));
      bay.append(at(shapes::heat_bleed(0.3F, 0.6F * height, between(random, 0.3, 2.5),
                                       i % 2 ? Material::concrete : Material::brick_wall),
                    {0.0F, between(random, -0.3, 0.3) * width, 0.35F * height}));
      bay.append(at(box({0.25F, 0.3F, height}, {Material::painted_metal}), {0.125F, -0.5F * width, 0.0F}));
      if (random.uniform() < 0.15) bay.append(at(shapes::door(2.4F, 2.6F), {0.05F, 0.0F, 0.0F}));
      scene.add(at(bay, point(middle, 0.0), side.yaw));
    }
  }
  const Vector3f x(static_cast<float>(hall.box.sizes().x()), 0.0F, 0.0F),
      y(0.0F, static_cast<float>(hall.box.sizes().y()), 0.0F);
  scene.add_ground(panel(point(a, 0.0), x, y, {Material::screed}));
  scene.add(panel(point(a, hall.height_m), y, x, {Material::galvanised}));
}

void add_roof_and_pillars(const Hall& hall, FloorPlan& plan, SceneBuilder& scene, Random& random) {
  const float length = static_cast<float>(hall.box.sizes().y()), z = static_cast<float>(hall.height_m);
  const double middle_y = hall.box.center().y();
  for (double x = hall.box.min().x() + 0.5 * kBay_m; x < hall.box.max().x(); x += kBay_m) {
    scene.add(at(shapes::i_beam(length, 0.45F), point({x, middle_y}, z - 0.45F)));
    for (double y = hall.box.min().y() + 0.5 * kBay_m; y < hall.box.max().y(); y += kBay_m) {
      Mesh pillar = box({0.35F, 0.35F, z - 0.45F}, {Material::concrete, between(random, -0.4, 0.4)});
      pillar.append(box({0.39F, 0.39F, 1.2F}, {Material::rail_paint}));
      put(pillar, {x, y}, 0.45, 0.45, hall.height_m, plan, scene);
      scene.add(at(shapes::ceiling_lamp(1.5F), point({x + 0.5 * kBay_m, y}, z - 0.3F)));
    }
  }
}

/// Pipes and a duct from end to end, at heights of their own, hung from the roof.
void add_pipe_racks(const Hall& hall, const Site& site, SceneBuilder& scene, Random& random) {
  const double low_m = std::max(2.6, site.bounds_P.max().z() + site.clearance_m + 0.3);
  const float from = static_cast<float>(hall.box.min().x()) + 0.6F, to = static_cast<float>(hall.box.max().x()) - 0.6F;
  for (double y = hall.box.min().y() + 1.2; y < hall.box.max().y() - 1.0; y += random.uniform(3.0, 5.5)) {
    const int pipes = 2 + static_cast<int>(random.uniform() * 4.0);
    const double z = random.uniform(low_m, hall.height_m - 1.2);
    for (int i = 0; i < pipes; ++i) {
      const float r = between(random, 0.03, 0.12), at_y = static_cast<float>(y) + 0.3F * static_cast<float>(i),
                  at_z = static_cast<float>(z);
      const float bend = from + between(random, 0.2, 0.8) * (to - from);
      const double choice = random.uniform();
      const Material material = choice < 0.35  ? Material::insulation
                                : choice < 0.6 ? Material::cold_pipe
                                : choice < 0.8 ? Material::stainless
                                               : Material::painted_metal;
      const float drop = between(random, 0.0, 0.6);
      scene.add(
          shapes::pipe(std::array{Vector3f(from, at_y, at_z), Vector3f(bend, at_y, at_z),
                                  Vector3f(bend, at_y, at_z + drop + 0.2F), Vector3f(to, at_y, at_z + drop + 0.2F)},
                       r, {material, between(random, -2.0, 10.0)}));
    }
    for (float x = from + 1.0F; x < to; x += 3.0F) {
      scene.add(at(box({0.05F, 0.3F * static_cast<float>(pipes) + 0.2F, 0.06F}, {Material::galvanised}),
                   {x, static_cast<float>(y) + 0.15F * static_cast<float>(pipes - 1), static_cast<float>(z) - 0.2F}));
      scene.add(shapes::tube(std::array{Vector3f(x, static_cast<float>(y) - 0.15F, static_cast<float>(z) - 0.2F),
                                        Vector3f(x, static_cast<float>(y) - 0.15F, static_cast<float>(hall.height_m))},
                             0.01F, 4, {Material::galvanised}));
    }
  }
  const float y = static_cast<float>(random.uniform(hall.box.min().y() + 1.5, hall.box.max().y() - 1.5)),
              z = static_cast<float>(hall.height_m) - 0.9F;
  scene.add(shapes::duct(std::array{Vector3f(from, y, z), Vector3f(to, y, z)}, 0.6F));
}

/// Rows of like machines between the pillars: the same again every few metres.
void add_machines(const Hall& hall, FloorPlan& plan, SceneBuilder& scene, Random& random) {
  for (double y = hall.box.min().y() + 1.6; y < hall.box.max().y() - 1.0; y += 2.5) {
    const double row = random.uniform();
    for (double x = hall.box.min().x() + 1.5; x < hall.box.max().x() - 1.0; x += row < 0.4 ? 1.9 : 2.4) {
      if (random.uniform() < 0.12) continue;
      if (row < 0.4) {
        put(shapes::pump_set(random), {x, y}, 0.9, 1.75, 2.2, plan, scene);
      } else if (row < 0.7) {
        const float radius = between(random, 0.5, 0.8), height = between(random, 2.0, 3.2);
        put(shapes::tank(radius, height, between(random, -4.0, 14.0)), {x, y}, 2.0 * radius + 0.4, 2.0 * radius + 0.4,
            height, plan, scene);
      } else {
        Mesh row_of_cabinets = shapes::cabinet({0.5F, 0.9F, 1.9F}, random);
        row_of_cabinets.append(at(shapes::cabinet({0.5F, 0.9F, 1.9F}, random), {0.0F, 0.92F, 0.0F}));
        put(at(row_of_cabinets, {0.0F, -0.46F, 0.0F}), {x, y}, 0.6, 1.9, 2.15, plan, scene);
      }
    }
  }
  for (int i = 0; i < static_cast<int>(hall.box.volume() / 12.0); ++i) {  // what lies about
    const Vector2d p(random.uniform(hall.box.min().x(), hall.box.max().x()),
                     random.uniform(hall.box.min().y(), hall.box.max().y()));
    if (!hall.box.contains(footprint(p, 0.9, 0.9))) continue;
    const double choice = random.uniform();
    if (choice < 0.4)
      put(shapes::box_pile(random), p, 0.65, 0.65, 1.3, plan, scene);
    else if (choice < 0.7)
      put(shapes::cylinder(0.29F, 0.88F, 18, {Material::painted_metal, between(random, -1.0, 1.0)}), p, 0.6, 0.6, 0.9,
          plan, scene);
    else
      put(shapes::toolbox(), p, 0.25, 0.45, 0.3, plan, scene);
  }
}

/// A grating with rails 3 m up along one wall, on posts.
void add_walkway(const Hall& hall, FloorPlan& plan, SceneBuilder& scene) {
  const double y = hall.box.min().y() + 0.7,
               z = std::max(3.0, plan.site().bounds_P.max().z() + plan.site().clearance_m + 0.2);
  for (double x = hall.box.min().x() + 1.5; x + 2.0 < hall.box.max().x(); x += 2.0) {
    Mesh piece = at(box({2.0F, 1.0F, 0.04F}, {Material::grating}), point({x, y}, z));
    piece.append(shapes::railing(std::array{point({x - 1.0, y + 0.5}, z), point({x + 1.0, y + 0.5}, z)}));
    if (!scene.add(piece)) continue;
    const Vector2d post(x - 1.0, y + 0.45);
    if (plan.free(footprint(post, 0.12, 0.12)))
      scene.add(at(box({0.1F, 0.1F, static_cast<float>(z)}, {Material::painted_metal}), point(post, 0.0)));
  }
}

/// Markings on the floor beside the way.
void add_markings(const Site& site, SceneBuilder& scene) {
  const auto& path = site.path_P.points();
  for (std::size_t i = 0; i + 10 < path.size(); i += 10) {
    const Vector2d p = path[i].head<2>(), step = path[i + 10].head<2>() - p;
    if (step.norm() < 0.3) continue;
    const float yaw = static_cast<float>(std::atan2(step.y(), step.x()));
    for (const float side : {-1.0F, 1.0F})
      scene.add_ground(
          at(panel({0.0F, side * 0.75F - 0.04F, 0.004F}, {0.8F * static_cast<float>(step.norm()), 0.0F, 0.0F},
                   {0.0F, 0.08F, 0.0F}, {Material::lane_paint}),
             point(p, 0.0), yaw));
  }
}

}  // namespace

Expected<PlaceParts> make_plant(const PlaceConfig& config) {
  Random random(config.seed, 40);
  const Site site = site_on_flat_ground(config, random.uniform(0.0, 1.5));
  FloorPlan plan(site);
  SceneBuilder scene(site);
  const double margin_m = site.clearance_m + random.uniform(4.0, 6.0);
  const Vector2d low = site.bounds_P.min().head<2>().array() - margin_m,
                 high = site.bounds_P.max().head<2>().array() + margin_m;
  const Hall hall{AlignedBox2d(low, high), std::max(random.uniform(6.0, 8.0), site.bounds_P.max().z() + 4.0)};
  add_shell(hall, scene, random);
  const AlignedBox2d inner(Vector2d(low.array() + 0.5), Vector2d(high.array() - 0.5));
  auto actors = add_findings(config, inner, 2.5, plan, scene);
  if (!actors) return std::unexpected(actors.error());
  add_roof_and_pillars(hall, plan, scene, random);
  add_pipe_racks(hall, site, scene, random);
  add_machines(hall, plan, scene, random);
  add_walkway(hall, plan, scene);
  add_markings(site, scene);
  for (Actor& walker : walkers_inside(config, inner, plan)) actors->push_back(std::move(walker));
  return indoors(config, std::move(*actors), scene);
}

}  // namespace pllit
