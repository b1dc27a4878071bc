// Small places with nothing left to chance, for tests of cameras.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "pllit/geometry/camera.hpp"
#include "pllit/sim/world/place.hpp"

namespace pllit {

/// A rectangle from four corners, counter-clockwise as seen from its front.
inline void add_rectangle(Mesh& mesh, const std::array<Vector3f, 4>& corners, std::uint32_t surface) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  mesh.surface.insert(mesh.surface.end(), 2, surface);
  mesh.warmer_K.insert(mesh.warmer_K.end(), 2, 0.0F);
}

/// A box with the given corners.
inline void add_box(Mesh& mesh, const Vector3f& low, const Vector3f& high, std::uint32_t surface) {
  const auto corner = [&](int i) {
    return Vector3f((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                    (i & 4) != 0 ? high.z() : low.z());
  };
  const std::array<std::array<int, 4>, 6> faces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& face : faces)
    add_rectangle(mesh, {corner(face[0]), corner(face[1]), corner(face[2]), corner(face[3])}, surface);
}

/// One tile, whatever is in it.
class TestPlace : public Place {
 public:
  std::vector<Surface> surfaces_;
  std::vector<Actor> actors_;
  Climate climate_;
  Mesh mesh_;

  const std::vector<Surface>& surfaces() const override { return surfaces_; }
  const std::vector<Actor>& actors() const override { return actors_; }
  const Climate& climate() const override { return climate_; }
  std::vector<std::uint32_t> tiles_near(const Eigen::Vector3d&, double) const override { return {0}; }
  Tile tile(std::uint32_t) const override { return {.mesh = mesh_}; }
};

inline Surface plain_surface(float excess_K, float albedo = 0.5F) {
  Surface surface;
  surface.albedo = albedo;
  surface.emissivity = 1.0F;
  surface.excess_K = excess_K;
  return surface;
}

/// A wall at y = 4 m, 40 m wide and high: surface 0 left of x = edge_x_m, 1 right of it.
inline TestPlace two_walls(double edge_x_m, Surface left, Surface right) {
  TestPlace place;
  place.surfaces_ = {std::move(left), std::move(right)};
  const auto edge = static_cast<float>(edge_x_m);
  add_rectangle(place.mesh_,
                {Vector3f(-20, 4, -20), Vector3f(edge, 4, -20), Vector3f(edge, 4, 20), Vector3f(-20, 4, 20)}, 0);
  add_rectangle(place.mesh_, {Vector3f(edge, 4, -20), Vector3f(20, 4, -20), Vector3f(20, 4, 20), Vector3f(edge, 4, 20)},
                1);
  return place;
}

/// A room of 8 x 8 x 3 m with a kettle that begins to boil after 10 s and a cart that drives past.
inline TestPlace room() {
  TestPlace place;
  place.surfaces_ = {plain_surface(0.0F, 0.6F), plain_surface(2.0F, 0.3F)};
  place.surfaces_[0].heat = {.kind = Texture::Kind::clouds, .scale_m = 2.0F, .contrast = 1.5F, .seed = 5};
  place.surfaces_[0].paint = {.kind = Texture::Kind::bricks, .scale_m = 0.4F, .contrast = 0.2F, .seed = 6};
  add_box(place.mesh_, {-4, -4, -1.5F}, {4, 4, 1.5F}, 0);
  Actor kettle;
  kettle.name = "kettle";
  kettle.path = {{.at_s = 0.0, .T_W_O = SE3(Vector3d(0.5, 3.0, 0.0), Eigen::Quaterniond::Identity())}};
  kettle.heating = {{.at_s = 10.0, .by_K = 70.0F, .over_s = 60.0}};
  add_box(kettle.mesh_O, {-0.2F, -0.2F, -0.2F}, {0.2F, 0.2F, 0.2F}, 1);
  Actor cart;
  cart.name = "cart";
  cart.path = {{.at_s = 0.0, .T_W_O = SE3(Vector3d(-3.0, 2.0, -1.0), Eigen::Quaterniond::Identity())},
               {.at_s = 10.0, .T_W_O = SE3(Vector3d(3.0, 2.0, -1.0), Eigen::Quaterniond::Identity())}};
  add_box(cart.mesh_O, {-0.4F, -0.3F, -0.4F}, {0.4F, 0.3F, 0.4F}, 1);
  place.actors_ = {kettle, cart};
  return place;
}

/// T_W_C of a camera at p_W that looks along +y of W, upright.
inline SE3 looking_along_y(const Vector3d& p_W = Vector3d::Zero()) {
  Matrix3d R_W_C;
  R_W_C << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return pose_from(rotation_from(Eigen::Quaterniond(R_W_C)), p_W);
}

/// 160 x 120 pixels, 45 degrees across.
inline Camera small_camera() { return {.width = 160, .height = 120, .fx = 193.0, .fy = 193.0, .cx = 79.5, .cy = 59.5}; }

}  // namespace pllit
