#include <algorithm>
#include <array>
#include <cmath>

#include "pllit/sim/places/shapes.hpp"

namespace pllit::shapes {
namespace {

/// What stands along z lies along y.
Mesh lying(Mesh mesh) {
  return moved(std::move(mesh), Eigen::Isometry3f(Eigen::AngleAxisf(-0.5F * kPi, Vector3f::UnitX())));
}

}  // namespace

Mesh cabinet(const Vector3f& size, Random& random) {
  const Finish paint{Material::cabinet, between(random, -1.0, 2.0)};
  Mesh mesh = at(box(size, paint), Vector3f::Zero());
  const float front = 0.5F * size.x();
  mesh.append(at(box({size.x() + 0.04F, size.y() + 0.04F, 0.08F}, {Material::dark_plastic}), Vector3f::Zero()));
  const int doors = size.y() > 0.75F ? 2 : 1;
  for (int d = 0; d < doors; ++d) {
    const float w = (size.y() - 0.04F) / static_cast<float>(doors),
                y = (static_cast<float>(d) + 0.5F) * w - 0.5F * size.y() + 0.02F;
    mesh.append(at(box({0.02F, w - 0.02F, size.z() - 0.2F}, paint), {front + 0.01F, y, 0.12F}));
    for (int i = 0; i < 6; ++i)
      for (const float z : {0.2F, size.z() - 0.35F})
        mesh.append(at(box({0.012F, 0.5F * w, 0.012F}, {Material::dark_plastic, 2.0F}),
                       {front + 0.022F, y, z + 0.025F * static_cast<float>(i)}));
    mesh.append(at(box({0.03F, 0.02F, 0.12F}, {Material::bare_metal}), {front + 0.03F, y + 0.4F * w, 0.5F * size.z()}));
    mesh.append(at(box({0.008F, 0.12F, 0.08F}, {Material::paper}), {front + 0.022F, y, 0.7F * size.z()}));
  }
  for (int i = 0; i < 3; ++i) {
    const float y = between(random, -0.35, 0.35) * size.y();
    mesh.append(tube(std::array{Vector3f(0.0F, y, size.z()), Vector3f(0.0F, y, size.z() + 0.25F)}, 0.018F, 6,
                     {Material::cable, 1.0F}));
  }
  return mesh;
}

Mesh motor(float length, float warmer_K) {
  const Finish paint{Material::motor, warmer_K};
  const float r = 0.28F * length, axis = 1.35F * r;
  Mesh mesh = at(lying(cylinder(r, length, 20, paint)), {0.0F, -0.5F * length, axis});
  for (int i = 0; i < 20; ++i) {
    const float angle = 2.0F * kPi * static_cast<float>(i) / 20.0F;
    const Eigen::Isometry3f turn(Eigen::AngleAxisf(angle, Vector3f::UnitY()));
    mesh.append(
        at(moved(at(box({0.015F, 0.75F * length, 0.12F * r}, paint), {0.0F, 0.0F, r}), turn), {0.0F, 0.0F, axis}));
  }
  mesh.append(at(lying(cylinder(1.05F * r, 0.12F * length, 20, {Material::dark_plastic, 2.0F})),
                 {0.0F, -0.5F * length - 0.02F, axis}));
  mesh.append(
      at(lying(cylinder(0.12F * r, 0.3F * length, 10, {Material::bare_metal, 5.0F})), {0.0F, 0.5F * length, axis}));
  mesh.append(at(box({0.5F * r, 0.4F * length, 0.5F * r}, paint), {0.0F, 0.0F, axis + 0.95F * r}));
  for (const float x : {-0.7F, 0.7F})
    mesh.append(at(box({0.3F * r, 0.7F * length, axis - 0.6F * r}, paint), {x * r, 0.0F, 0.0F}));
  return mesh;
}

Mesh pump_set(Random& random) {
  Mesh mesh = box({0.7F, 1.6F, 0.18F}, {Material::concrete});
  mesh.append(at(box({0.55F, 1.5F, 0.08F}, {Material::painted_metal}), {0.0F, 0.0F, 0.18F}));
  mesh.append(at(motor(0.65F, between(random, -6.0, 12.0)), {0.0F, -0.35F, 0.26F}));
  const Finish body{random.uniform() < 0.5 ? Material::painted_metal : Material::cold_pipe};
  mesh.append(at(lying(cylinder(0.11F, 0.16F, 14, {Material::painted_metal})), {0.0F, 0.1F, 0.5F}));
  mesh.append(at(lying(cylinder(0.24F, 0.2F, 20, body)), {0.0F, 0.35F, 0.52F}));
  mesh.append(at(box({0.3F, 0.15F, 0.25F}, body), {0.0F, 0.45F, 0.26F}));
  mesh.append(pipe(std::array{Vector3f(0.15F, 0.45F, 0.52F), Vector3f(0.15F, 0.45F, 2.2F)}, 0.06F, body));
  mesh.append(pipe(std::array{Vector3f(0.0F, 0.55F, 0.52F), Vector3f(0.0F, 0.78F, 0.52F)}, 0.08F, body));
  mesh.append(at(flange(0.06F), {0.15F, 0.45F, 1.2F}));
  mesh.append(cable({0.0F, -0.35F, 0.8F}, {-0.3F, -0.75F, 0.15F}, 0.15F, 0.015F));
  return mesh;
}

Mesh tank(float radius, float height, float warmer_K) {
  const Finish shell{Material::tank, warmer_K};
  const float foot = 0.45F, dish = 0.3F * radius;
  std::vector<Vector2f> profile;
  for (int i = 0; i <= 4; ++i) {
    const float a = 0.125F * kPi * static_cast<float>(i);
    profile.emplace_back(radius * std::sin(a), foot + dish * (1.0F - std::cos(a)));
  }
  for (int i = 4; i >= 0; --i)
    profile.emplace_back(profile[static_cast<std::size_t>(i)].x(),
                         height - (profile[static_cast<std::size_t>(i)].y() - foot));
  Mesh mesh = lathe(profile, 28, shell);
  for (int i = 0; i < 4; ++i) {
    const float a = 0.5F * kPi * (static_cast<float>(i) + 0.5F);
    mesh.append(at(cylinder(0.05F, foot + dish, 8, {Material::painted_metal}),
                   {0.85F * radius * std::cos(a), 0.85F * radius * std::sin(a), 0.0F}));
  }
  for (int i = 1; i < 4; ++i) {
    const float z = foot + dish + (height - foot - 2.0F * dish) * 0.25F * static_cast<float>(i);
    mesh.append(at(cylinder(radius + 0.015F, 0.05F, 28, shell), {0.0F, 0.0F, z}));
  }
  mesh.append(at(moved(cylinder(0.22F, 0.1F, 16, {Material::painted_metal}),
                       Eigen::Isometry3f(Eigen::AngleAxisf(0.5F * kPi, Vector3f::UnitY()))),
                 {radius - 0.03F, 0.0F, 0.45F * height}));
  mesh.append(
      pipe(std::array{Vector3f(0.0F, 0.0F, foot), Vector3f(0.0F, 0.0F, 0.2F), Vector3f(0.0F, radius + 0.15F, 0.2F)},
           0.05F, {Material::insulation, 8.0F}));
  mesh.append(pipe(std::array{Vector3f(0.0F, 0.0F, height), Vector3f(0.0F, 0.0F, height + 0.5F)}, 0.05F,
                   {Material::insulation}));
  for (const float y : {-0.2F, 0.2F})
    mesh.append(tube(std::array{Vector3f(-radius - 0.1F, y, 0.2F), Vector3f(-radius - 0.1F, y, height)}, 0.02F, 5,
                     {Material::rail_paint}));
  for (float z = 0.4F; z < height; z += 0.3F)
    mesh.append(tube(std::array{Vector3f(-radius - 0.1F, -0.2F, z), Vector3f(-radius - 0.1F, 0.2F, z)}, 0.012F, 4,
                     {Material::rail_paint}));
  return mesh;
}

Mesh flange(float radius) {
  const float r = radius;
  const std::array profile{Vector2f(r, -3.0F * r),        Vector2f(1.7F * r, -3.0F * r), Vector2f(1.7F * r, -2.4F * r),
                           Vector2f(1.2F * r, -2.2F * r), Vector2f(1.6F * r, 0.0F),      Vector2f(1.2F * r, 2.2F * r),
                           Vector2f(1.7F * r, 2.4F * r),  Vector2f(1.7F * r, 3.0F * r),  Vector2f(r, 3.0F * r)};
  Mesh mesh = lathe(profile, 16, {Material::painted_metal});
  mesh.append(tube(std::array{Vector3f(r, 0.0F, 0.0F), Vector3f(3.5F * r, 0.0F, 0.0F)}, 0.3F * r, 8,
                   {Material::painted_metal}));
  mesh.append(tube(std::array{Vector3f(3.5F * r, 0.0F, 0.0F), Vector3f(3.7F * r, 0.0F, 0.0F)}, 2.0F * r, 14,
                   {Material::painted_metal}));
  return mesh;
}

Mesh duct(std::span<const Vector3f> line, float side) {
  // A tube of four sides, its diagonal twice the radius; seams stand out by a centimetre.
  const float radius = side * std::numbers::sqrt2_v<float> / 2.0F;
  Mesh mesh = tube(line, radius, 4, {Material::galvanised});
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector3f step = line[i + 1] - line[i];
    const int seams = static_cast<int>(step.norm() / 1.5F);
    for (int k = 1; k <= seams; ++k) {
      const Vector3f p = line[i] + step * (static_cast<float>(k) / static_cast<float>(seams + 1)),
                     half = 0.02F * step.normalized();
      mesh.append(
          tube(std::array{Vector3f(p - half), Vector3f(p + half)}, radius + 0.025F, 4, {Material::galvanised, 0.2F}));
    }
  }
  return mesh;
}

Mesh i_beam(float length, float height) {
  const Finish steel{Material::painted_metal, -0.3F};
  Mesh mesh = at(box({0.02F, length, height}, steel), Vector3f::Zero());
  for (const float z : {0.0F, height - 0.02F})
    mesh.append(at(box({0.5F * height, length, 0.02F}, steel), {0.0F, 0.0F, z}));
  return mesh;
}

Mesh railing(std::span<const Vector3f> foot_line) {
  Mesh mesh;
  const Finish paint{Material::rail_paint};
  for (const float z : {0.5F, 1.0F}) {
    std::vector<Vector3f> rail(foot_line.begin(), foot_line.end());
    for (Vector3f& p : rail) p.z() += z;
    mesh.append(tube(rail, 0.02F, 6, paint));
  }
  for (std::size_t i = 0; i + 1 < foot_line.size(); ++i) {
    const Vector3f step = foot_line[i + 1] - foot_line[i];
    const int posts = std::max(1, static_cast<int>(step.head<2>().norm() / 1.2F));
    for (int k = 0; k <= posts; ++k)
      mesh.append(at(cylinder(0.02F, 1.0F, 6, paint),
                     foot_line[i] + step * (static_cast<float>(k) / static_cast<float>(posts))));
  }
  return mesh;
}

}  // namespace pllit::shapes
