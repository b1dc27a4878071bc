#include "pllit/sim/places/scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pllit {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

/// The first tile is centred on the origin and holds most rooms as a whole: rays are slowed by each border they cross.
constexpr double kTile_m = 48.0;
constexpr double kSlack_m = 0.02;  // kept beyond the clearance: for rounding to float and between the path's points

class AssembledPlace final : public Place {
 public:
  explicit AssembledPlace(PlaceParts parts) : parts_(std::move(parts)) {}

  const std::vector<Surface>& surfaces() const override { return parts_.surfaces; }
  const std::vector<Actor>& actors() const override { return parts_.actors; }
  const Climate& climate() const override { return parts_.climate; }

  std::vector<std::uint32_t> tiles_near(const Vector3d& p_W, double radius_m) const override {
    std::vector<std::uint32_t> near;
    for (std::uint32_t i = 0; i < parts_.tiles.size(); ++i)
      if (parts_.tiles[i].bounds_W.exteriorDistance(p_W) <= radius_m) near.push_back(i);
    return near;
  }
  Tile tile(std::uint32_t index) const override { return {parts_.tiles.at(index).origin_W, parts_.mesh(index)}; }

 private:
  PlaceParts parts_;
};

}  // namespace

std::unique_ptr<Place> assembled(PlaceParts parts) { return std::make_unique<AssembledPlace>(std::move(parts)); }

namespace {

Climate indoor_climate(Light light) {
  Climate climate;
  climate.air_K = 294.15;
  climate.air_drift_Kph = 0.4;
  climate.sky_K = 273.15;
  climate.ambient_light = light == Light::day ? 0.6 : 0.005;
  return climate;
}

}  // namespace

PlaceParts indoors(const PlaceConfig& config, std::vector<Actor> actors, const SceneBuilder& scene) {
  PlaceParts parts;
  parts.surfaces = palette(config.seed, config.light == Light::day);
  parts.climate = indoor_climate(config.light);
  parts.actors = std::move(actors);
  scene.build(parts);
  return parts;
}

Climate outdoor_climate(Light light, std::uint64_t seed) {
  Random random(seed, 90);
  const bool day = light == Light::day;
  const double elevation_rad = random.uniform(0.5, 1.0), azimuth_rad = random.uniform(-3.0, 3.0);
  Climate climate;
  climate.air_K = day ? 291.15 : 281.15;
  climate.air_swing_K = 5.0;
  climate.sky_K = day ? 258.15 : 250.15;
  climate.to_sun_W = {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
                      std::sin(elevation_rad)};
  climate.sun = day ? 0.8 : 0.0;
  climate.ambient_light = day ? 0.5 : 0.02;
  return climate;
}

bool SceneBuilder::add(const Mesh& piece_P) {
  if (site_.path_P.meets(piece_P, Vector3d::Zero(), site_.clearance_m + kSlack_m)) return false;
  add_ground(piece_P);
  return true;
}

void SceneBuilder::add_ground(const Mesh& piece_P) {
  if (piece_P.vertices.empty()) return;
  Eigen::AlignedBox3f box;
  for (const Vector3f& v : piece_P.vertices) box.extend(v);
  const Vector3f centre = box.center();
  const auto cell = [](float v) { return static_cast<int>(std::floor(v / kTile_m + 0.5)); };
  cells_[{cell(centre.x()), cell(centre.y())}].append(piece_P);
}

void SceneBuilder::build(PlaceParts& parts) const {
  std::vector<Mesh> meshes;
  for (const auto& [cell, mesh_P] : cells_) {
    const Vector3d origin_P(cell.first * kTile_m, cell.second * kTile_m, 0.0);
    const Vector3d origin_W = site_.T_W_P.act(origin_P);
    Mesh mesh = mesh_P;
    Eigen::AlignedBox3d bounds_W;
    for (Vector3f& v : mesh.vertices) {
      const Vector3d p = site_.T_W_P.rotation() * (v.cast<double>() - origin_P);
      v = p.cast<float>();
      bounds_W.extend(v.cast<double>() + origin_W);
    }
    parts.tiles.push_back({origin_W, bounds_W});
    meshes.push_back(std::move(mesh));
  }
  parts.mesh = [meshes = std::move(meshes)](std::uint32_t index) { return meshes[index]; };
}

AlignedBox2d footprint(const Vector2d& centre, double size_x, double size_y) {
  const Vector2d half(0.5 * size_x, 0.5 * size_y);
  return {Vector2d(centre - half), Vector2d(centre + half)};
}

bool FloorPlan::off_path(const AlignedBox2d& box, double distance_m) const {
  const double reach_m = distance_m + 0.5 * box.diagonal().norm();
  if (site_.path_P.nearest(box.center(), reach_m).distance_m >= reach_m) return true;
  for (const Vector3d& p : site_.path_P.points())
    if (box.exteriorDistance(Vector2d(p.head<2>())) < distance_m) return false;
  return true;
}

bool FloorPlan::free(const AlignedBox2d& box, double gap_m) const {
  const AlignedBox2d wide(Vector2d(box.min().array() - gap_m), Vector2d(box.max().array() + gap_m));
  const auto overlaps = [&](const Footprint& other) { return other.box.intersects(wide); };
  return std::ranges::none_of(taken_, overlaps) && off_path(box, site_.clearance_m + 0.1);
}

bool FloorPlan::sees(const Vector2d& a, const Vector2d& b, double z_m) const {
  const int steps = std::max(1, static_cast<int>((b - a).norm() / 0.03));
  for (int i = 1; i < steps; ++i) {
    const Vector2d p = a + (b - a) * (static_cast<double>(i) / steps);
    if (std::ranges::any_of(taken_, [&](const Footprint& f) { return f.top_m > z_m && f.box.contains(p); }))
      return false;
  }
  return true;
}

}  // namespace pllit
