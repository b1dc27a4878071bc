// What only some kinds of place promise, and what their surfaces are.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>

#include "pllit/sim/places/make_place.hpp"
#include "pllit/sim/places/shapes.hpp"
#include "pllit/sim/places/site.hpp"
#include "pllit/sim/world/ray_caster.hpp"

namespace pllit {
namespace {

using Path = std::vector<Vector3d>;

Path rounded_square_path() {
  Path path;
  for (int i = 0; i <= 120; ++i) {
    const double a = 2.0 * std::numbers::pi * i / 120.0;
    path.emplace_back(6.0 * std::cos(a), 4.0 * std::sin(a), 1.3);
  }
  return path;
}

Path line_path(double length_m) {
  Path path;
  for (double x = 0.0; x <= length_m; x += 0.5) path.emplace_back(0.8 * x, 0.6 * x, 2.3);
  return path;
}

PlaceConfig inspection(PlaceKind kind, std::uint64_t seed) {
  PlaceConfig config{.kind = kind, .seed = seed, .path_W = rounded_square_path(), .duration_s = 60.0};
  using Kind = FindingSpec::Kind;
  using Arrival = FindingSpec::Arrival;
  config.findings = {{Kind::on_table, Arrival::brought_in_hot, 20.0, 20.0},
                     {Kind::cabinet, Arrival::heated_in_place, 25.0, 12.0},
                     {Kind::pipe, Arrival::heated_in_place, 30.0, 18.0}};
  config.distractors = {{DistractorSpec::Kind::cold_object, 15.0}, {DistractorSpec::Kind::hot_radiator, 0.0}};
  return config;
}

std::unique_ptr<Place> made(const PlaceConfig& config) {
  auto place = make_place(config);
  EXPECT_TRUE(place.has_value()) << place.error().message;
  return place ? std::move(*place) : nullptr;
}

std::size_t triangles_within(const Place& place, const Vector3d& p_W, double radius_m) {
  std::size_t count = 0;
  for (const std::uint32_t i : place.tiles_near(p_W, radius_m)) count += place.tile(i).mesh.triangles.size();
  return count;
}

/// How many points of the path see the point, from nearer than reach_m.
int views_of(const Vector3d& p_W, const Path& path, const Place& place, double reach_m, double at_s,
             std::uint32_t actor) {
  RayCaster caster(place, 30.0);
  caster.move_to(path.front(), at_s);
  int views = 0;
  for (const Vector3d& eye : path) {
    const Vector3d way = p_W - eye;
    if (way.norm() > reach_m) continue;
    const Hit hit = caster.cast({eye, way.normalized()});
    views += hit && hit.actor == actor;
  }
  return views;
}

TEST(Findings, AreWhereTheyClaimAndInSightOfThePath) {
  for (const PlaceKind kind : {PlaceKind::room, PlaceKind::plant})
    for (const std::uint64_t seed : {1, 2, 3}) {
      const PlaceConfig config = inspection(kind, seed);
      const auto place = made(config);
      ASSERT_NE(place, nullptr);
      ASSERT_GE(place->actors().size(), 5U);
      for (std::uint32_t i = 0; i < 5; ++i) {
        const Actor& actor = place->actors()[i];
        EXPECT_EQ(actor.finding, i < 3) << actor.name;
        const Vector3d centroid_W = visible_centroid_W(actor, 60.0, config.path_W);
        double least_m = 1e9, corner_m = 1e9;
        for (const Vector3d& p : config.path_W) least_m = std::min(least_m, (p - centroid_W).norm());
        for (const Vector3f& v : actor.mesh_O.vertices)
          corner_m = std::min(corner_m, (actor.pose(60.0).act(v.cast<double>()) - centroid_W).norm());
        EXPECT_GE(least_m, 1.2) << actor.name;
        EXPECT_LE(least_m, 4.0) << actor.name;
        EXPECT_LE(corner_m, 0.7) << actor.name;
        EXPECT_GE(views_of(centroid_W, config.path_W, *place, 4.5, 60.0, i), 3) << actor.name << " seed " << seed;
      }
    }
}

TEST(Findings, HeatOrAppearAsSpecifiedAndDistractorsDoNot) {
  const auto place = made(inspection(PlaceKind::room, 5));
  ASSERT_NE(place, nullptr);
  const auto& actors = place->actors();
  EXPECT_DOUBLE_EQ(actors[0].appears_s, 20.0);
  EXPECT_TRUE(actors[0].heating.empty());
  EXPECT_GE(*std::ranges::min_element(actors[0].mesh_O.warmer_K), 15.0F);
  ASSERT_EQ(actors[1].heating.size(), 1U);
  EXPECT_DOUBLE_EQ(actors[1].heating[0].at_s, 25.0);
  EXPECT_FLOAT_EQ(actors[1].heating[0].by_K, 12.0F);
  EXPECT_LT(*std::ranges::max_element(actors[3].mesh_O.warmer_K), 0.0F);
  EXPECT_DOUBLE_EQ(actors[3].appears_s, 15.0);
  EXPECT_TRUE(actors[4].heating.empty());
}

TEST(Findings, AreElsewhereWithAnotherSeed) {
  const PlaceConfig a = inspection(PlaceKind::room, 1), b = inspection(PlaceKind::room, 2);
  const auto in_a = made(a), in_b = made(b);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_GT(
        (visible_centroid_W(in_a->actors()[i], 60.0, a.path_W) - visible_centroid_W(in_b->actors()[i], 60.0, b.path_W))
            .norm(),
        0.3);
}

/// Share of the surface within 30 m of the middle that faces along the corridor.
double share_facing_along(const PlaceConfig& config) {
  const auto place = made(config);
  const Vector3d middle = 0.5 * (config.path_W.front() + config.path_W.back()), axis(0.8, 0.6, 0.0);
  double along = 0.0, area = 0.0;
  for (const std::uint32_t i : place->tiles_near(middle, 30.0)) {
    const Tile tile = place->tile(i);
    for (const auto& t : tile.mesh.triangles) {
      const auto corner = [&](std::size_t k) { return Vector3d(tile.mesh.vertices[t[k]].cast<double>()); };
      const Vector3d normal = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0));
      if ((corner(0) + tile.origin_W - middle).norm() > 30.0) continue;
      along += std::abs(normal.dot(axis));
      area += normal.norm();
    }
  }
  EXPECT_GT(area, 200.0);
  return along / area;
}

TEST(Corridor, BareShowsNothingThatFacesAlongItAroundItsMiddle) {
  EXPECT_LT(share_facing_along({.kind = PlaceKind::corridor, .seed = 3, .path_W = line_path(60.0), .bare = true}),
            1e-3);
}

TEST(Corridor, ShowsLittleThatFacesAlongIt) {
  for (const std::uint64_t seed : {3, 4, 5}) {
    const double share = share_facing_along({.kind = PlaceKind::corridor, .seed = seed, .path_W = line_path(60.0)});
    EXPECT_GT(share, 0.002);
    EXPECT_LT(share, 0.05);
  }
}

/// Along x for 30 m, up two flights with a half turn between, and back for 30 m.
std::vector<Vector3d> corridor_stairs_corridor() {
  std::vector<Vector3d> path;
  for (double x = -30.0; x < 0.0; x += 0.1) path.emplace_back(x, 0.0, 1.3);
  for (double x = 0.0; x < 3.0; x += 0.1) path.emplace_back(x, 0.0, 1.3 + 0.6 * x);
  for (double a = -0.5; a < 0.5; a += 0.05)
    path.emplace_back(3.6 + 0.7 * std::cos(3.14159 * a), 0.7 + 0.7 * std::sin(3.14159 * a), 3.1);
  for (double x = 3.0; x > 0.0; x -= 0.1) path.emplace_back(x, 1.4, 3.1 + 0.6 * (3.0 - x));
  for (double x = 0.0; x > -30.0; x -= 0.1) path.emplace_back(x, 1.4, 4.9);
  return path;
}

TEST(Stairs, LevelWaysAreCorridorsThatOpenIntoTheWell) {
  const PlaceConfig config{.kind = PlaceKind::stairs, .seed = 2, .path_W = corridor_stairs_corridor()};
  const auto place = made(config);
  ASSERT_NE(place, nullptr);
  RayCaster caster(*place, 100.0);
  for (const auto& [eye, floor_z] :
       {std::pair(Vector3d(-20.0, 0.0, 1.3), 0.0), std::pair(Vector3d(-20.0, 1.4, 4.9), 3.6)}) {
    caster.move_to(eye, 0.0);
    const auto range_m = [&](const Vector3d& direction) { return caster.cast({eye, direction}).range_m; };
    EXPECT_NEAR(range_m(-Vector3d::UnitZ()), eye.z() - floor_z, 0.2);
    EXPECT_LT(range_m(Vector3d::UnitZ()), 1.6F);
    EXPECT_LT(range_m(Vector3d::UnitY()), 1.8F);
    EXPECT_LT(range_m(-Vector3d::UnitY()), 1.8F);
    EXPECT_GT(range_m(Vector3d::UnitX()), 20.0F) << "sees into the stairwell";
    EXPECT_LT(range_m(Vector3d::UnitX()), 30.0F);
    EXPECT_GT(range_m(-Vector3d::UnitX()), 15.0F);
  }
}

TEST(Street, JoinsItsTilesWithoutGaps) {
  PlaceConfig config{.kind = PlaceKind::street, .seed = 3, .path_W = line_path(300.0), .clearance_m = 2.5};
  const auto place = made(config);
  ASSERT_NE(place, nullptr);
  RayCaster caster(*place, 60.0);
  for (const Vector3d& p : config.path_W) {
    caster.move_to(p, 0.0);
    for (const double aside_m : {-3.0, -0.5, 0.5, 3.0, 7.5}) {
      const Vector3d eye = p + aside_m * Vector3d(-0.6, 0.8, 0.0);
      const Hit hit = caster.cast({eye, -Vector3d::UnitZ()});
      ASSERT_TRUE(hit) << p.transpose();
      EXPECT_LT(hit.range_m, 1.5F);
    }
  }
}

TEST(Place, StaysWithinItsTriangleBudget) {
  const PlaceConfig room = inspection(PlaceKind::room, 1);
  const auto in_room = made(room);
  EXPECT_GT(triangles_within(*in_room, room.path_W.front(), 1e4), 20'000U);
  EXPECT_LT(triangles_within(*in_room, room.path_W.front(), 1e4), 400'000U);
  PlaceConfig config{.kind = PlaceKind::street, .seed = 3, .path_W = line_path(300.0), .clearance_m = 2.5};
  const auto street = made(config);
  for (const std::uint32_t i : street->tiles_near(config.path_W.front(), 1e4)) {
    EXPECT_LT(street->tile(i).mesh.triangles.size(), 30'000U);
    EXPECT_GT(street->tile(i).mesh.triangles.size(), 3'000U);
  }
}

TEST(Actors, KeepTheirDistanceFromThePath) {
  PlaceConfig room = inspection(PlaceKind::room, 4);
  room.people = 4;
  PlaceConfig street{
      .kind = PlaceKind::street, .seed = 3, .path_W = line_path(300.0), .clearance_m = 2.5, .people = 4, .cars = 3};
  for (const PlaceConfig& config : {room, street}) {
    const auto place = made(config);
    int movers = 0;
    for (const Actor& actor : place->actors()) {
      if (actor.path.size() < 2) continue;
      ++movers;
      for (double t_s = 0.0; t_s < config.duration_s; t_s += 0.5)
        for (const Vector3d& p : config.path_W) ASSERT_GE((actor.pose(t_s).translation() - p).head<2>().norm(), 1.5);
    }
    EXPECT_GT(movers, 0);
    EXPECT_LE(movers, config.people + config.cars);
  }
}

TEST(Palette, IsPhysical) {
  const auto surfaces = palette(1, true);
  ASSERT_EQ(surfaces.size(), static_cast<std::size_t>(Material::count));
  for (const Surface& s : surfaces) {
    EXPECT_FALSE(s.name.empty());
    for (const float share : {s.reflectivity, s.albedo, s.emissivity, s.mirror, s.follows_air, s.sees_sky}) {
      EXPECT_GE(share, 0.0F) << s.name;
      EXPECT_LE(share, 1.0F) << s.name;
    }
    EXPECT_LE(std::abs(s.excess_K), 60.0F) << s.name;
    EXPECT_GE(s.sun_K, 0.0F) << s.name;
    EXPECT_LE(s.sun_K, 30.0F) << s.name;
    EXPECT_GT(s.paint.scale_m, 0.0F) << s.name;
    EXPECT_LE(s.heat.contrast, 2.0F) << s.name;
  }
  EXPECT_LE(surfaces[static_cast<std::size_t>(Material::bare_metal)].emissivity, 0.3F);
  EXPECT_GT(surfaces[static_cast<std::size_t>(Material::bare_metal)].mirror, 0.3F);
  EXPECT_EQ(palette(1, false)[static_cast<std::size_t>(Material::lamp)].glow, 0.0F);
}

TEST(Shapes, HaveOneSurfaceAndOneWarmthForEachTriangle) {
  Random random(3);
  for (const Mesh& mesh : {shapes::desk(random), shapes::shelf(1.0F, 2.0F, random), shapes::pump_set(random),
                           shapes::tank(0.6F, 2.5F, 0.0F), shapes::tree(6.0F, 300, random), shapes::car(random),
                           shapes::person(random), shapes::house({}, random)}) {
    ASSERT_GT(mesh.triangles.size(), 100U);
    EXPECT_EQ(mesh.surface.size(), mesh.triangles.size());
    EXPECT_EQ(mesh.warmer_K.size(), mesh.triangles.size());
    for (const auto& t : mesh.triangles)
      for (const std::uint32_t corner : t) ASSERT_LT(corner, mesh.vertices.size());
    for (const Vector3f& v : mesh.vertices) ASSERT_TRUE(v.allFinite());
  }
}

}  // namespace
}  // namespace pllit
