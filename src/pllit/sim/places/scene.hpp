// What generators fill and what becomes of it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "pllit/sim/places/shapes.hpp"
#include "pllit/sim/places/site.hpp"

namespace pllit {

/// Everything that a place consists of. `mesh` makes the mesh of a tile from its index alone.
struct PlaceParts {
  struct TilePlan {
    Vector3d origin_W;
    Eigen::AlignedBox3d bounds_W;
  };
  std::vector<Surface> surfaces;
  std::vector<Actor> actors;
  Climate climate;
  std::vector<TilePlan> tiles;
  std::function<Mesh(std::uint32_t)> mesh;
};

std::unique_ptr<Place> assembled(PlaceParts parts);

/// Air, sky and light outdoors.
Climate outdoor_climate(Light light, std::uint64_t seed);

/// Collects pieces given in P and sorts them into tiles.
class SceneBuilder {
 public:
  explicit SceneBuilder(const Site& site) : site_(site) {}

  /// Takes the piece unless it comes closer to the path than allowed; tells whether it did.
  bool add(const Mesh& piece_P);
  /// Takes what may be near the path: the ground.
  void add_ground(const Mesh& piece_P);

  /// Fills in tiles and mesh.
  void build(PlaceParts& parts) const;

 private:
  const Site& site_;
  std::map<std::pair<int, int>, Mesh> cells_;
};

/// Where in P things stand: rectangles that are taken, up to a height.
class FloorPlan {
 public:
  struct Footprint {
    Eigen::AlignedBox2d box;
    double top_m;
  };
  explicit FloorPlan(const Site& site) : site_(site) {}

  /// Whether nothing is there and the path keeps its clearance, with `gap_m` to spare between footprints.
  bool free(const Eigen::AlignedBox2d& box, double gap_m = 0.05) const;
  /// Whether the path keeps a distance from the box.
  bool off_path(const Eigen::AlignedBox2d& box, double distance_m) const;
  void take(const Eigen::AlignedBox2d& box, double top_m) { taken_.push_back({box, top_m}); }
  /// Whether anything taller than z_m stands between two places.
  bool sees(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double z_m) const;
  const Site& site() const { return site_; }

 private:
  const Site& site_;
  std::vector<Footprint> taken_;
};

/// A place under a roof: lit by its lamps by day and dark by night, its air and its pieces.
PlaceParts indoors(const PlaceConfig& config, std::vector<Actor> actors, const SceneBuilder& scene);

Eigen::AlignedBox2d footprint(const Eigen::Vector2d& centre, double size_x, double size_y);

}  // namespace pllit
