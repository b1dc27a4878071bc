// Places are made around motions: what must hold for all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "pllit/sim/places/make_place.hpp"
#include "pllit/sim/places/site.hpp"
#include "pllit/sim/places/surfaces.hpp"
#include "pllit/sim/random.hpp"
#include "support/imu_recording.hpp"
#include "support/recordings.hpp"

namespace pllit {
namespace {

using Path = std::vector<Vector3d>;

Path loop_path() {
  Path path;
  for (int i = 0; i <= 80; ++i) {
    const double a = 2.0 * std::numbers::pi * i / 80.0;
    path.emplace_back(3.0 * std::cos(a), 2.0 * std::sin(a), 1.3 + 0.02 * std::sin(9.0 * a));
  }
  return path;
}

Path straight_path(double length_m) {
  Path path;
  for (double x = 0.0; x <= length_m; x += 0.25)
    path.emplace_back(0.8 * x, 0.6 * x + 0.2 * std::sin(x), 5.3 + 0.02 * std::sin(7.0 * x));
  return path;
}

/// Up three flights, with turns of half a circle on landings between them.
Path climbing_path() {
  Path path;
  Vector3d p(0.0, 0.0, 1.3);
  for (int flight = 0; flight < 3; ++flight) {
    const double way = flight % 2 ? -1.0 : 1.0;
    for (int i = 0; i < 30; ++i) path.push_back(p += Vector3d(0.1 * way, 0.0, 0.058));
    for (int i = 0; i < 10; ++i) path.push_back(p += Vector3d(0.08 * way, 0.0, 0.0));
    for (int i = 0; i < 17; ++i) path.push_back(p += Vector3d(0.0, 0.1 * way, 0.0));
    for (int i = 0; i < 10; ++i) path.push_back(p -= Vector3d(0.08 * way, 0.0, 0.0));
  }
  return path;
}

/// An L with both arms driven twice, on different lanes.
Path drive_path() {
  Path path;
  for (double s = 0.0; s < 160.0; s += 1.0) path.emplace_back(s, 0.0, 0.02 * s);
  for (double s = 0.0; s < 90.0; s += 1.0) path.emplace_back(160.0, s, 3.2);
  for (double s = 90.0; s > 3.0; s -= 1.0) path.emplace_back(156.8, s, 3.2);
  for (double s = 156.0; s > 40.0; s -= 1.0) path.emplace_back(s, 3.0, 0.02 * s + 0.3);
  return path;
}

PlaceConfig config_of(PlaceKind kind, Path path, std::uint64_t seed) {
  const bool wide = kind == PlaceKind::street;
  return {.kind = kind,
          .seed = seed,
          .path_W = std::move(path),
          .duration_s = 60.0,
          .height_m = 1.3,
          .clearance_m = wide ? 2.5 : 0.6};
}

std::unique_ptr<Place> made(const PlaceConfig& config) {
  auto place = make_place(config);
  EXPECT_TRUE(place.has_value()) << place.error().message;
  return place ? std::move(*place) : nullptr;
}

std::vector<std::uint32_t> all_tiles(const Place& place, const PlaceConfig& config) {
  return place.tiles_near(config.path_W.front(), 1e6);
}

std::size_t tiles_closer_than(double clearance_m, const Place& place, const PlaceConfig& config) {
  const auto points = densified(config.path_W, 0.25);
  const PathIndex index(points);
  std::size_t count = 0;
  for (const std::uint32_t i : all_tiles(place, config)) {
    const Tile tile = place.tile(i);
    Mesh walls;  // all but the ground
    walls.vertices = tile.mesh.vertices;
    for (std::size_t t = 0; t < tile.mesh.triangles.size(); ++t)
      if (!is_ground(static_cast<Material>(tile.mesh.surface[t]))) walls.triangles.push_back(tile.mesh.triangles[t]);
    if (index.meets(walls, tile.origin_W, clearance_m)) ++count;
  }
  return count;
}

void expect_clear(const PlaceConfig& config) {
  const auto place = made(config);
  ASSERT_NE(place, nullptr);
  ASSERT_FALSE(all_tiles(*place, config).empty());
  EXPECT_EQ(tiles_closer_than(config.clearance_m, *place, config), 0U) << "seed " << config.seed;
  if (config.kind == PlaceKind::field) return;
  EXPECT_GT(tiles_closer_than(6.0 + config.clearance_m, *place, config), 0U) << "nothing is near at all";
}

/// A path as recorded, mirrored, backwards and smaller.
std::vector<Path> variants(const Path& path) {
  Path mirrored = path, backwards(path.rbegin(), path.rend()), small = path;
  for (Vector3d& p : mirrored) p.y() = -p.y();
  for (Vector3d& p : small) p.head<2>() *= 0.6;
  return {path, mirrored, backwards, small};
}

TEST(PathIndex, FindsTheSameNearestPointsAndMeetingsAsASearchOfAll) {
  Random random(5);
  std::vector<Vector3d> points;
  for (int i = 0; i < 200; ++i) points.push_back(6.0 * random.gaussian3());
  const PathIndex index(points);
  for (int i = 0; i < 100; ++i) {
    const Vector3d p = 8.0 * random.gaussian3();
    double least_m = 1e9;
    for (const Vector3d& q : points) least_m = std::min(least_m, (q - p).head<2>().norm());
    EXPECT_DOUBLE_EQ(index.nearest(p.head<2>(), 40.0).distance_m, std::min(least_m, 40.0));
    Mesh mesh;
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back((p + random.gaussian3()).cast<float>());
    mesh.triangles = {{0, 1, 2}};
    const auto corner = [&](int k) { return Vector3d(mesh.vertices[static_cast<std::size_t>(k)].cast<double>()); };
    const bool meets = std::ranges::any_of(
        points, [&](const Vector3d& q) { return distance_to_triangle(q, corner(0), corner(1), corner(2)) < 1.0; });
    EXPECT_EQ(index.meets(mesh, Vector3d::Zero(), 1.0), meets);
  }
}

TEST(PathIndex, DistanceToATriangleIsTheLeastOverItsPoints) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Vector3d p = random.gaussian3(), a = random.gaussian3(), b = random.gaussian3(), c = random.gaussian3();
    double least_m = 1e9;
    for (int u = 0; u <= 60; ++u)
      for (int v = 0; u + v <= 60; ++v)
        least_m = std::min(least_m, (a + (b - a) * u / 60.0 + (c - a) * v / 60.0 - p).norm());
    EXPECT_NEAR(distance_to_triangle(p, a, b, c), least_m, 0.05);
    EXPECT_LE(distance_to_triangle(p, a, b, c), least_m + 1e-9);
  }
}

TEST(Place, KeepsItsClearanceFromSyntheticMotions) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    expect_clear(config_of(PlaceKind::room, loop_path(), seed));
    expect_clear(config_of(PlaceKind::plant, loop_path(), seed));
    expect_clear(config_of(PlaceKind::field, loop_path(), seed));
    expect_clear(config_of(PlaceKind::corridor, straight_path(60.0), seed));
    expect_clear(config_of(PlaceKind::stairs, climbing_path(), seed));
    expect_clear(config_of(PlaceKind::street, drive_path(), seed));
  }
}

TEST(Place, KeepsItsClearanceFromARecordedWalk) {
  PLLIT_RECORDING(walk, "trajectories/hilti2022_exp04.tum");
  constexpr std::array kOthers{PlaceKind::plant, PlaceKind::corridor, PlaceKind::stairs, PlaceKind::plant};
  const auto paths = variants(positions_of(test::read_trajectory_text(walk)));
  for (std::size_t i = 0; i < paths.size(); ++i) {
    expect_clear(config_of(PlaceKind::room, paths[i], 10 + i));
    expect_clear(config_of(kOthers[i], paths[i], 20 + i));
  }
}

TEST(Place, KeepsItsClearanceFromARecordedDrive) {
  PLLIT_RECORDING(drive, "trajectories/kitti_07.tum");
  const Path path = positions_of(test::read_trajectory_text(drive));
  auto config = config_of(PlaceKind::street, path, 7);
  config.height_m = 1.7;
  expect_clear(config);
}

TEST(Place, KeepsTheGroundBelowTheMotion) {
  for (const auto& config :
       {config_of(PlaceKind::room, loop_path(), 4), config_of(PlaceKind::stairs, climbing_path(), 4),
        config_of(PlaceKind::street, drive_path(), 4), config_of(PlaceKind::field, drive_path(), 4)}) {
    const auto place = made(config);
    ASSERT_NE(place, nullptr);
    const PathIndex index(densified(config.path_W, 0.25));
    std::size_t touching = 0;
    for (const std::uint32_t i : all_tiles(*place, config)) {
      const Tile tile = place->tile(i);
      touching += index.meets(tile.mesh, tile.origin_W, 0.4) ? 1 : 0;
    }
    EXPECT_EQ(touching, 0U) << static_cast<int>(config.kind);
  }
}

TEST(Place, DependsOnItsSeedAloneAndOnAllOfIt) {
  for (const auto& [kind, path] :
       {std::pair(PlaceKind::room, loop_path()), std::pair(PlaceKind::street, drive_path())}) {
    const auto config = config_of(kind, path, 8), other = config_of(kind, path, 9);
    const auto a = made(config), b = made(config), c = made(other);
    const auto tiles = all_tiles(*a, config);
    ASSERT_EQ(tiles, all_tiles(*b, config));
    bool differs = all_tiles(*c, other).size() != tiles.size();
    for (auto i = tiles.rbegin(); i != tiles.rend(); ++i) b->tile(*i);  // the order of making must not matter
    for (const std::uint32_t i : tiles) {
      const Tile first = a->tile(i), again = b->tile(i);
      EXPECT_TRUE(first.origin_W == again.origin_W && first.mesh.vertices == again.mesh.vertices &&
                  first.mesh.triangles == again.mesh.triangles && first.mesh.surface == again.mesh.surface &&
                  first.mesh.warmer_K == again.mesh.warmer_K);
      differs = differs || c->tile(i).mesh.vertices != first.mesh.vertices;
    }
    EXPECT_TRUE(differs);
  }
}

TEST(Place, RefusesWhatItCannotMake) {
  EXPECT_FALSE(make_place(config_of(PlaceKind::room, {Vector3d::Zero()}, 1)));
  auto config = config_of(PlaceKind::room, loop_path(), 1);
  config.path_W[3].x() = std::nan("");
  const auto bad_path = make_place(config);
  ASSERT_FALSE(bad_path);
  EXPECT_NE(bad_path.error().message.find("point 3"), std::string::npos);
  config = config_of(PlaceKind::street, drive_path(), 1);
  config.findings = {{}};
  EXPECT_FALSE(make_place(config));
  config = config_of(PlaceKind::room, loop_path(), 1);
  config.clearance_m = 0.0;
  EXPECT_FALSE(make_place(config));
}

}  // namespace
}  // namespace pllit
