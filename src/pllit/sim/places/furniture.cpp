#include <algorithm>
#include <array>
#include <cmath>

#include "pllit/sim/places/shapes.hpp"

namespace pllit::shapes {
namespace {

Material one_of(std::span<const Material> materials, Random& random) {
  return materials[static_cast<std::size_t>(random.uniform() * static_cast<double>(materials.size()))];
}

}  // namespace

Mesh table(const Vector3f& size, Material top) {
  Mesh mesh = at(box({size.x(), size.y(), 0.03F}, {top}), {0.0F, 0.0F, size.z() - 0.03F});
  for (const float x : {-0.5F, 0.5F})
    for (const float y : {-0.5F, 0.5F})
      mesh.append(at(box({0.05F, 0.05F, size.z() - 0.03F}, {Material::painted_metal}),
                     {x * (size.x() - 0.1F), y * (size.y() - 0.1F), 0.0F}));
  mesh.append(at(box({0.02F, size.y() - 0.15F, 0.3F}, {top}), {-0.42F * size.x(), 0.0F, size.z() - 0.35F}));
  return mesh;
}

Mesh chair(Material seat) {
  Mesh mesh = at(box({0.45F, 0.45F, 0.06F}, {seat, 0.5F}), {0.0F, 0.0F, 0.42F});
  mesh.append(at(box({0.05F, 0.42F, 0.4F}, {seat}), {-0.22F, 0.0F, 0.55F}));
  mesh.append(at(cylinder(0.03F, 0.36F, 8, {Material::bare_metal}), {0.0F, 0.0F, 0.06F}));
  for (int i = 0; i < 5; ++i) {
    const float angle = 2.0F * kPi * static_cast<float>(i) / 5.0F;
    const Vector3f foot(0.28F * std::cos(angle), 0.28F * std::sin(angle), 0.04F);
    mesh.append(tube(std::array{Vector3f(0.0F, 0.0F, 0.08F), foot}, 0.02F, 5, {Material::dark_plastic}));
    mesh.append(at(sphere(0.03F, 6, {Material::dark_plastic}), {foot.x(), foot.y(), 0.03F}));
  }
  return mesh;
}

Mesh desk(Random& random) {
  Mesh mesh = table({0.7F, 1.4F, 0.73F}, random.uniform() < 0.5 ? Material::wood : Material::light_plastic);
  const float y = between(random, -0.3, 0.3), warm_K = between(random, 0.0, 8.0);
  mesh.append(at(box({0.04F, 0.55F, 0.33F}, {Material::screen, warm_K}), {-0.2F, y, 0.85F}));
  mesh.append(at(box({0.03F, 0.06F, 0.14F}, {Material::dark_plastic}), {-0.2F, y, 0.73F}));
  mesh.append(at(box({0.2F, 0.22F, 0.015F}, {Material::dark_plastic}), {-0.2F, y, 0.73F}));
  mesh.append(at(box({0.14F, 0.42F, 0.02F}, {Material::dark_plastic}), {0.12F, y, 0.73F}));
  for (int i = 0; i < 4; ++i)
    mesh.append(at(box({0.3F, 0.21F, between(random, 0.003, 0.03)}, {Material::paper}),
                   {between(random, -0.15, 0.15), between(random, -0.5, 0.5), 0.73F}, between(random, -0.5, 0.5)));
  mesh.append(at(cylinder(0.04F, 0.1F, 10, {Material::ceramic, between(random, 0.0, 12.0)}), {0.1F, y - 0.33F, 0.73F}));
  mesh.append(at(box({0.45F, 0.2F, 0.42F}, {Material::dark_plastic, warm_K}), {-0.05F, 0.55F, 0.02F}));
  mesh.append(cable({-0.22F, y, 0.85F}, {-0.3F, 0.5F, 0.4F}, 0.2F, 0.006F));
  return mesh;
}

Mesh shelf(float width, float height, Random& random) {
  const int boards = std::max(2, static_cast<int>(height / 0.38F));
  const float step = (height - 0.03F) / static_cast<float>(boards);
  const Material wood = random.uniform() < 0.5 ? Material::wood : Material::painted_metal;
  constexpr std::array kContents{Material::books, Material::books, Material::cardboard, Material::light_plastic,
                                 Material::dark_plastic};
  Mesh mesh = at(box({0.01F, width, height}, {wood}), {-0.17F, 0.0F, 0.0F});
  for (const float side : {-0.5F, 0.5F})
    mesh.append(at(box({0.35F, 0.025F, height}, {wood}), {0.0F, side * width, 0.0F}));
  for (int b = 0; b <= boards; ++b) {
    const float z = static_cast<float>(b) * step;
    mesh.append(at(box({0.35F, width, 0.025F}, {wood}), {0.0F, 0.0F, z}));
    if (b == boards) break;
    for (float y = -0.5F * width + 0.03F; y < 0.5F * width - 0.1F;) {
      const bool wide = random.uniform() < 0.25;
      const float w =
          std::min(wide ? between(random, 0.15, 0.4) : between(random, 0.03, 0.09), 0.5F * width - 0.03F - y);
      const float h = between(random, 0.5, 0.9) * (step - 0.03F), d = between(random, 0.18, 0.3);
      const Material material = wide ? one_of(kContents, random) : Material::books;
      if (random.uniform() < 0.85)
        mesh.append(at(box({d, w - 0.004F, h}, {material, between(random, -0.3, 0.4)}),
                       {0.5F * (0.3F - d) - 0.02F, y + 0.5F * w, z + 0.025F}));
      y += w;
    }
  }
  return mesh;
}

Mesh radiator(float width, float height, float warmer_K) {
  const Finish paint{Material::radiator, warmer_K};
  Mesh mesh;
  const int ribs = std::max(3, static_cast<int>(width / 0.09F));
  for (int i = 0; i < ribs; ++i) {
    const float y = ((static_cast<float>(i) + 0.5F) / static_cast<float>(ribs) - 0.5F) * width;
    mesh.append(at(box({0.1F, 0.05F, height}, paint), {0.0F, y, 0.12F}));
  }
  for (const float z : {0.16F, 0.06F + height})
    mesh.append(tube(std::array{Vector3f(0.0F, -0.5F * width - 0.06F, z), Vector3f(0.0F, 0.5F * width + 0.02F, z)},
                     0.025F, 8, paint));
  mesh.append(
      tube(std::array{Vector3f(0.0F, -0.5F * width - 0.06F, 0.16F), Vector3f(0.0F, -0.5F * width - 0.06F, 0.0F)},
           0.012F, 6, paint));
  mesh.append(at(cylinder(0.02F, 0.07F, 8, {Material::light_plastic}), {0.0F, -0.5F * width - 0.06F, 0.06F + height}));
  return mesh;
}

Mesh window(float width, float height) {
  constexpr float kBar = 0.06F;
  const Finish frame{Material::window_frame};
  Mesh mesh = panel({0.0F, -0.5F * width, 0.0F}, {0.0F, width, 0.0F}, {0.0F, 0.0F, height}, {Material::window_glass});
  for (const float y : {-0.5F * width + 0.5F * kBar, 0.0F, 0.5F * width - 0.5F * kBar})
    mesh.append(at(box({kBar, kBar, height}, frame), {0.0F, y, 0.0F}));
  for (const float z : {0.0F, height - kBar}) mesh.append(at(box({kBar, width, kBar}, frame), {0.0F, 0.0F, z}));
  return mesh;
}

Mesh door(float width, float height) {
  const Finish frame{Material::door_frame};
  Mesh mesh = box({0.04F, width - 0.1F, height - 0.05F}, {Material::door_leaf});
  for (const float y : {-0.5F, 0.5F})
    mesh.append(at(box({0.06F, 0.06F, height}, frame), {0.0F, y * (width - 0.06F), 0.0F}));
  mesh.append(at(box({0.06F, width, 0.06F}, frame), {0.0F, 0.0F, height - 0.06F}));
  for (const float x : {-0.05F, 0.05F})
    mesh.append(at(box({0.015F, 0.12F, 0.02F}, {Material::bare_metal}), {x, 0.38F * width, 1.03F}));
  return mesh;
}

Mesh plant_pot(Random& random) {
  const std::array profile{Vector2f(0.0F, 0.0F), Vector2f(0.13F, 0.0F), Vector2f(0.18F, 0.32F), Vector2f(0.15F, 0.32F),
                           Vector2f(0.0F, 0.28F)};
  Mesh mesh = lathe(profile, 14, {Material::ceramic});
  mesh.append(at(bush(between(random, 0.6, 1.1), 160, random), {0.0F, 0.0F, 0.3F}));
  return mesh;
}

Mesh box_pile(Random& random) {
  Mesh mesh;
  float z = 0.0F;
  for (float side = between(random, 0.4, 0.6); side > 0.2F; side *= between(random, 0.6, 0.9)) {
    const float h = between(random, 0.25, 0.45), x = between(random, -0.05, 0.05), y = between(random, -0.05, 0.05);
    const float yaw = between(random, -0.3, 0.3);
    mesh.append(at(box({side, 0.8F * side, h}, {Material::cardboard}), {x, y, z}, yaw));
    mesh.append(at(box({0.06F, 0.8F * side, 0.002F}, {Material::light_plastic}), {x, y, z + h}, yaw));
    z += h + 0.002F;
    if (z > 1.3F) break;
  }
  return mesh;
}

Mesh ceiling_lamp(float length) {
  Mesh mesh = at(box({0.2F, length, 0.06F}, {Material::painted_metal}), {0.0F, 0.0F, -0.31F});
  mesh.append(at(box({0.14F, length - 0.04F, 0.03F}, {Material::lamp}), {0.0F, 0.0F, -0.34F}));
  for (const float y : {-0.4F, 0.4F})
    mesh.append(tube(std::array{Vector3f(0.0F, y * length, 0.0F), Vector3f(0.0F, y * length, -0.25F)}, 0.006F, 4,
                     {Material::cable}));
  return mesh;
}

Mesh kettle() {
  const std::array profile{Vector2f(0.0F, 0.0F),    Vector2f(0.09F, 0.0F),  Vector2f(0.1F, 0.03F),
                           Vector2f(0.085F, 0.18F), Vector2f(0.05F, 0.23F), Vector2f(0.02F, 0.235F),
                           Vector2f(0.02F, 0.26F),  Vector2f(0.0F, 0.27F)};
  Mesh mesh = lathe(profile, 20, {Material::ceramic});
  mesh.append(tube(std::array{Vector3f(-0.08F, 0.0F, 0.05F), Vector3f(-0.15F, 0.0F, 0.07F),
                              Vector3f(-0.15F, 0.0F, 0.18F), Vector3f(-0.06F, 0.0F, 0.21F)},
                   0.012F, 7, {Material::ceramic}));
  mesh.append(
      tube(std::array{Vector3f(0.07F, 0.0F, 0.1F), Vector3f(0.14F, 0.0F, 0.18F)}, 0.018F, 8, {Material::ceramic}));
  return mesh;
}

Mesh toolbox() {
  Mesh mesh = box({0.22F, 0.42F, 0.2F}, {Material::painted_metal});
  mesh.append(at(box({0.23F, 0.43F, 0.02F}, {Material::painted_metal}), {0.0F, 0.0F, 0.12F}));
  mesh.append(tube(std::array{Vector3f(0.0F, -0.12F, 0.2F), Vector3f(0.0F, -0.12F, 0.27F), Vector3f(0.0F, 0.12F, 0.27F),
                              Vector3f(0.0F, 0.12F, 0.2F)},
                   0.012F, 6, {Material::painted_metal}));
  return mesh;
}

}  // namespace pllit::shapes
