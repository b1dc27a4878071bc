// Small places to test in, and a ray caster that tries every triangle in double.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "pllit/sim/random.hpp"
#include "pllit/sim/world/place.hpp"
#include "pllit/sim/world/ray_caster.hpp"

namespace pllit::testing {

/// A place whose tiles lie there ready; counts how often they were asked for.
class ReadyPlace : public Place {
 public:
  const std::vector<Surface>& surfaces() const override { return surfaces_; }
  const std::vector<Actor>& actors() const override { return actors_; }
  const Climate& climate() const override { return climate_; }
  std::vector<std::uint32_t> tiles_near(const Eigen::Vector3d& p_W, double radius_m) const override {
    std::vector<std::uint32_t> near;
    for (std::uint32_t i = 0; i < tiles_.size(); ++i) {
      Eigen::AlignedBox3d box;
      for (const auto& v : tiles_[i].mesh.vertices) box.extend(tiles_[i].origin_W + v.cast<double>());
      if (!box.isEmpty() && box.exteriorDistance(p_W) <= radius_m) near.push_back(i);
    }
    return near;
  }
  Tile tile(std::uint32_t index) const override {
    ++made_;
    return tiles_[index];
  }

  std::vector<Surface> surfaces_;
  std::vector<Actor> actors_;
  std::vector<Tile> tiles_;
  Climate climate_;
  mutable int made_ = 0;
};

inline void add_triangle(Mesh& mesh, const Vector3d& a, const Vector3d& b, const Vector3d& c, std::uint32_t surface,
                         float warmer_K = 0.0F) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vector3d& corner : {a, b, c}) mesh.vertices.push_back(corner.cast<float>());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.surface.push_back(surface);
  mesh.warmer_K.push_back(warmer_K);
}

/// The parallelogram with a corner and two edges.
inline void add_sheet(Mesh& mesh, const Vector3d& corner, const Vector3d& u, const Vector3d& v, std::uint32_t surface) {
  add_triangle(mesh, corner, corner + u, corner + u + v, surface);
  add_triangle(mesh, corner, corner + u + v, corner + v, surface);
}

/// The six sides of a box between two corners; seen from inside, it is a room.
inline void add_box(Mesh& mesh, const Vector3d& low, const Vector3d& high, std::uint32_t surface) {
  const Vector3d size = high - low;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d u = size[(axis + 1) % 3] * Vector3d::Unit((axis + 1) % 3);
    const Vector3d v = size[(axis + 2) % 3] * Vector3d::Unit((axis + 2) % 3);
    add_sheet(mesh, low, u, v, surface);
    add_sheet(mesh, low + size[axis] * Vector3d::Unit(axis), u, v, surface);
  }
}

inline SE3 random_pose(Random& random, double reach_m) {
  const Vector3d p(random.uniform(-reach_m, reach_m), random.uniform(-reach_m, reach_m), random.uniform(0.0, 3.0));
  return pose_from(exp_so3(random.gaussian3()), p);
}

/// Three by three tiles of 40 m with boxes and loose triangles about a point of the world, and five moving boxes.
inline ReadyPlace random_place(std::uint64_t seed, const Vector3d& middle_W) {
  Random random(seed);
  ReadyPlace place;
  place.surfaces_.resize(8);
  const auto surface = [&] { return static_cast<std::uint32_t>(random.bits() % 8); };
  for (int i = 0; i < 9; ++i) {
    Tile tile{.origin_W = middle_W + 40.0 * Vector3d(i % 3 - 1.5, i / 3 - 1.5, 0.0), .mesh = {}};
    add_sheet(tile.mesh, Vector3d::Zero(), 40.0 * Vector3d::UnitX(), 40.0 * Vector3d::UnitY(), surface());
    for (int box = 0; box < 8; ++box) {
      const Vector3d low(random.uniform(0.0, 38.0), random.uniform(0.0, 38.0), random.uniform(-1.0, 3.0));
      add_box(tile.mesh, low, low + Vector3d(random.uniform(0.1, 2), random.uniform(0.1, 2), random.uniform(0.1, 4)),
              surface());
    }
    for (int loose = 0; loose < 20; ++loose) {
      const Vector3d at(random.uniform(0.0, 40.0), random.uniform(0.0, 40.0), random.uniform(0.0, 5.0));
      add_triangle(tile.mesh, at, at + random.gaussian3(), at + random.gaussian3(), surface(),
                   static_cast<float>(random.uniform()));
    }
    place.tiles_.push_back(tile);
  }
  for (int i = 0; i < 5; ++i) {
    Actor actor{.name = "box", .mesh_O = {}, .path = {}, .heating = {}};
    add_box(actor.mesh_O, -Vector3d::Ones(), Vector3d(0.5, 1.0, 2.0), surface());
    for (int at = 0; at < 4; ++at) {
      const SE3 pose = random_pose(random, 30.0);
      actor.path.push_back({.at_s = 3.0 * at, .T_W_O = pose_from(pose.asSO3(), pose.translation() + middle_W)});
    }
    actor.appears_s = i;
    actor.vanishes_s = i + 6.0;
    place.actors_.push_back(actor);
  }
  return place;
}

/// A ray's nearest triangle by trying them all (Moeller and Trumbore, "Fast, minimum storage ray-triangle
/// intersection", 1997), in double.
class EveryTriangle {
 public:
  EveryTriangle(const Place& place, const std::vector<std::uint32_t>& tiles, double t_s) {
    for (const std::uint32_t index : tiles) {
      const Tile tile = place.tile(index);
      add(tile.mesh, pose_from(SO3::Identity(), tile.origin_W), Hit::kStatic);
    }
    for (std::size_t i = 0; i < place.actors().size(); ++i) {
      const Actor& actor = place.actors()[i];
      if (t_s >= actor.appears_s && t_s < actor.vanishes_s)
        add(actor.mesh_O, actor.pose(t_s), static_cast<std::uint32_t>(i));
    }
  }

  struct Nearest {
    double range_m = std::numeric_limits<double>::infinity();
    Vector3d normal_W, p_O;
    std::uint32_t surface = 0, actor = Hit::kStatic;
    float warmer_K = 0.0F;
  };

  std::optional<Nearest> cast(const Ray& ray, double reach_m) const {
    Nearest nearest{.range_m = reach_m, .normal_W = Vector3d::Zero(), .p_O = Vector3d::Zero()};
    bool found = false;
    for (const Triangle& triangle : triangles_) {
      const Vector3d u = triangle.b - triangle.a, v = triangle.c - triangle.a, h = ray.direction_W.cross(v);
      const double determinant = u.dot(h);
      if (std::abs(determinant) < 1e-14) continue;
      const Vector3d s = (ray.origin_W - triangle.a) / determinant, q = s.cross(u);
      const double share_u = s.dot(h), share_v = ray.direction_W.dot(q), range_m = v.dot(q);
      if (share_u < 0.0 || share_v < 0.0 || share_u + share_v > 1.0 || range_m < 0.0 || range_m >= nearest.range_m)
        continue;
      found = true;
      Vector3d normal_W = u.cross(v).normalized();
      if (normal_W.dot(ray.direction_W) > 0.0) normal_W = -normal_W;
      nearest = {.range_m = range_m,
                 .normal_W = normal_W,
                 .p_O = triangle.T_O_W.act(ray.origin_W + range_m * ray.direction_W),
                 .surface = triangle.surface,
                 .actor = triangle.actor,
                 .warmer_K = triangle.warmer_K};
    }
    return found ? std::optional(nearest) : std::nullopt;
  }

 private:
  struct Triangle {
    Vector3d a, b, c;
    SE3 T_O_W;
    std::uint32_t surface, actor;
    float warmer_K;
  };

  void add(const Mesh& mesh, const SE3& T_W_O, std::uint32_t actor) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto corner = [&](int k) -> Vector3d {
        return T_W_O.act(mesh.vertices[mesh.triangles[i][static_cast<std::size_t>(k)]].cast<double>());
      };
      triangles_.push_back(
          {corner(0), corner(1), corner(2), T_W_O.inverse(), mesh.surface[i], actor, mesh.warmer_K[i]});
    }
  }

  std::vector<Triangle> triangles_;
};

inline Vector3d random_direction(Random& random) { return random.gaussian3().normalized(); }

}  // namespace pllit::testing
