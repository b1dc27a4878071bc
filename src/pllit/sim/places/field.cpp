#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>

#include "pllit/sim/places/generators.hpp"
#include "pllit/sim/places/ground.hpp"
#include "pllit/sim/places/inhabitants.hpp"

namespace pllit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

constexpr double kTile_m = 60.0;
constexpr double kAside_m = 130.0;  // land on either side of the path
constexpr int kCells = 20;          // a tile's side

struct Wave {
  Vector2d k;
  double phase, height_m;
};

struct Field {
  PlaceConfig config;
  Site site;
  Ground ground;
  std::vector<Wave> waves;
  std::vector<std::pair<int, int>> cells;

  /// As below the path near it; further off hills of a metre or two.
  double z(const Vector2d& p) const {
    const double distance_m = site.path_P.nearest(p, 45.0).distance_m;
    const double share = std::clamp((distance_m - 6.0) / 39.0, 0.0, 1.0);
    double hills_m = 0.0;
    for (const Wave& w : waves) hills_m += w.height_m * std::sin(w.k.dot(p) + w.phase);
    return ground.z(p) + share * share * (3.0 - 2.0 * share) * hills_m;
  }
};

Mesh ground_of(const Field& field, const Vector3d& origin) {
  const float side = static_cast<float>(kTile_m);
  Mesh mesh =
      shapes::panel(Vector3f::Zero(), {side, 0.0F, 0.0F}, {0.0F, side, 0.0F}, {Material::grass}, kCells, kCells);
  for (Vector3f& v : mesh.vertices) {
    const Vector2d p(origin.x() + static_cast<double>(v.x()), origin.y() + static_cast<double>(v.y()));
    v.z() = static_cast<float>(field.z(p) - origin.z());
  }
  return mesh;
}

Mesh one_thing(Random& random) {
  const double choice = random.uniform();
  if (choice < 0.05) return shapes::tree(between(random, 4.0, 9.0), 700, random);
  if (choice < 0.15) return shapes::bush(between(random, 0.6, 1.6), 220, random);
  if (choice < 0.2)
    return shapes::at(shapes::sphere(between(random, 0.2, 0.6), 9, {Material::concrete}), {0.0F, 0.0F, 0.1F});
  return shapes::bush(between(random, 0.15, 0.4), 14, random);  // tufts
}

Mesh tile_of(const Field& field, std::uint32_t index, const Vector3d& origin) {
  Random random(field.config.seed, 2000 + index);
  Mesh mesh = ground_of(field, origin);
  const auto put = [&](const Mesh& thing, const Vector2d& p) {
    const Vector3f at = (Vector3d(p.x(), p.y(), field.z(p)) - origin).cast<float>();
    const Mesh placed = shapes::at(thing, at, between(random, 0.0, 6.0));
    if (!field.site.path_P.meets(placed, origin, field.site.clearance_m + 0.02)) mesh.append(placed);
  };
  const auto anywhere = [&] {
    return Vector2d(origin.x() + random.uniform(0.0, kTile_m), origin.y() + random.uniform(0.0, kTile_m));
  };
  for (int i = 0; i < 40; ++i) {
    const Mesh thing = one_thing(random);
    put(thing, anywhere());
  }
  if (random.uniform() < 0.3) {  // a row of posts
    const Vector2d from = anywhere(), step = 4.0 * (anywhere() - from).normalized();
    for (int i = 0; i < 6; ++i) put(shapes::cylinder(0.06F, 1.3F, 7, {Material::bark}), from + i * step);
  }
  return mesh;
}

/// People on straight lines beside the path.
std::vector<Actor> strollers(const Field& field) {
  Random random(field.config.seed, 73);
  std::vector<Actor> people;
  const auto& path = field.site.path_P.points();
  for (int attempt = 0; attempt < 200 * field.config.people && static_cast<int>(people.size()) < field.config.people;
       ++attempt) {
    const Vector2d near = path[static_cast<std::size_t>(random.uniform() * static_cast<double>(path.size()))].head<2>();
    const double angle = random.uniform(0.0, 6.2831853), heading = random.uniform(0.0, 6.2831853);
    const Vector2d from = near + random.uniform(3.0, 12.0) * Vector2d(std::cos(angle), std::sin(angle));
    std::vector<Vector3d> line;
    for (int i = 0; i < 12; ++i) {
      const Vector2d p = from + i * Vector2d(std::cos(heading), std::sin(heading));
      if (field.site.path_P.nearest(p, 2.0).distance_m < 2.0) break;
      line.emplace_back(p.x(), p.y(), field.z(p));
    }
    if (line.size() < 4) continue;
    people.push_back(pacing("person", shapes::person(random), line, random.uniform(0.8, 1.5), random.uniform(),
                            field.config.duration_s, field.site.T_W_P));
  }
  return people;
}

std::vector<Wave> hills(std::uint64_t seed) {
  Random random(seed, 50);
  std::vector<Wave> waves;
  for (int i = 0; i < 5; ++i) {
    const double length_m = random.uniform(25.0, 90.0), angle = random.uniform(0.0, 6.2831853);
    waves.push_back({6.2831853 / length_m * Vector2d(std::cos(angle), std::sin(angle)), random.uniform(0.0, 6.2831853),
                     0.008 * length_m});
  }
  return waves;
}

std::vector<std::pair<int, int>> cells_along(const Site& site) {
  std::map<std::pair<int, int>, bool> cells;
  const auto cell = [](double v) { return static_cast<int>(std::floor(v / kTile_m)); };
  for (std::size_t i = 0; i < site.path_P.points().size(); i += 20) {
    const Vector3d& p = site.path_P.points()[i];
    for (int x = cell(p.x() - kAside_m); x <= cell(p.x() + kAside_m); ++x)
      for (int y = cell(p.y() - kAside_m); y <= cell(p.y() + kAside_m); ++y) cells[{x, y}] = true;
  }
  std::vector<std::pair<int, int>> sorted;
  for (const auto& [key, used] : cells) sorted.push_back(key);
  return sorted;
}

}  // namespace

Expected<PlaceParts> make_field(const PlaceConfig& config) {
  const Site site = site_on_slopes(config, 0.0);
  const auto field = std::make_shared<const Field>(config, site, Ground(site), hills(config.seed), cells_along(site));
  const auto origin_of = [](const Field& f, std::uint32_t index) {
    const Vector2d corner(f.cells[index].first * kTile_m, f.cells[index].second * kTile_m);
    return Vector3d(corner.x(), corner.y(), f.ground.z(corner));
  };
  PlaceParts parts;
  parts.surfaces = palette(config.seed, config.light == Light::night);
  parts.climate = outdoor_climate(config.light, config.seed);
  parts.actors = strollers(*field);
  for (std::uint32_t i = 0; i < field->cells.size(); ++i) {
    const Vector3d origin_W = site.T_W_P.act(origin_of(*field, i));
    const double rise_m = site.bounds_P.sizes().z() + 8.0;
    parts.tiles.push_back({origin_W,
                           {Vector3d(origin_W - Vector3d(2.0, 2.0, rise_m)),
                            Vector3d(origin_W + Vector3d(kTile_m + 2.0, kTile_m + 2.0, rise_m + 6.0))}});
  }
  parts.mesh = [field, origin_of](std::uint32_t index) { return tile_of(*field, index, origin_of(*field, index)); };
  return parts;
}

}  // namespace pllit
