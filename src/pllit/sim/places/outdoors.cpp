#include <algorithm>
#include <array>
#include <cmath>

#include "pllit/sim/places/shapes.hpp"

namespace pllit::shapes {
namespace {

/// Leaves, each a small quad, spread over the outer part of an ellipsoid: a LiDAR sees some volume, not a shell.
Mesh crown(const Vector3f& centre, const Vector3f& radii, int leaf_count, float leaf, Random& random) {
  Mesh mesh;
  for (int i = 0; i < leaf_count; ++i) {
    const Vector3f direction = random.gaussian3().normalized().cast<float>();
    const Vector3f p = centre + between(random, 0.55, 1.0) * radii.cwiseProduct(direction);
    const Vector3f u = random.gaussian3().normalized().cast<float>();
    const Vector3f v = u.cross(Vector3f(random.gaussian3().normalized().cast<float>())).normalized();
    const float size = leaf * between(random, 0.6, 1.4);
    mesh.append(panel(p - 0.5F * size * (u + v), size * u, size * v, {Material::leaves, between(random, -0.4, 0.4)}));
  }
  return mesh;
}

Mesh window_of_house(float width, float height) {
  Mesh mesh = panel({-0.12F, -0.5F * width, 0.0F}, {0.0F, width, 0.0F}, {0.0F, 0.0F, height}, {Material::window_glass});
  mesh.append(at(box({0.05F, 0.07F, height}, {Material::window_frame}), {-0.1F, 0.0F, 0.0F}));
  mesh.append(at(box({0.05F, width, 0.07F}, {Material::window_frame}), {-0.1F, 0.0F, 0.0F}));
  mesh.append(at(box({0.05F, width, 0.07F}, {Material::window_frame}), {-0.1F, 0.0F, height - 0.07F}));
  mesh.append(at(box({0.16F, width + 0.16F, 0.05F}, {Material::kerb}), {0.04F, 0.0F, -0.05F}));
  return mesh;
}

Mesh roof(float width, float depth, float z, float ridge, Material wall) {
  const float w = 0.5F * width, eave = 0.35F;
  const Vector3f front(eave, -w, z), back(-depth - eave, -w, z), top(-0.5F * depth, -w, z + ridge),
      across(0.0F, width, 0.0F);
  Mesh mesh = panel(front, across, top - front, {Material::roof_tiles});
  mesh.append(panel(back, top - back, across, {Material::roof_tiles}));
  for (const float y : {-w, w}) {  // gables: a triangle each, as a quad with two corners in one
    const Vector3f a(0.0F, y, z), b(-depth, y, z), tip(-0.5F * depth, y, z + ridge);
    Mesh gable = panel(a, b - a, tip - a, {wall});
    gable.triangles.resize(1);
    gable.surface.resize(1);
    gable.warmer_K.resize(1);
    gable.vertices = {a, b, tip, tip};
    gable.triangles[0] = {0, 1, 2};
    mesh.append(gable);
  }
  return mesh;
}

}  // namespace

Mesh tree(float height, int leaf_count, Random& random) {
  const float trunk = between(random, 0.3, 0.4) * height, r = 0.02F * height + 0.05F;
  const std::array profile{Vector2f(1.5F * r, 0.0F), Vector2f(r, 0.3F), Vector2f(0.8F * r, trunk),
                           Vector2f(0.3F * r, 0.75F * height)};
  Mesh mesh = lathe(profile, 9, {Material::bark});
  for (int i = 0; i < 5; ++i) {
    const float a = 2.0F * kPi * (static_cast<float>(i) + between(random, 0.0, 0.5)) / 5.0F,
                reach = between(random, 0.12, 0.22) * height;
    mesh.append(tube(std::array{Vector3f(0.0F, 0.0F, trunk), Vector3f(reach * std::cos(a), reach * std::sin(a),
                                                                      trunk + between(random, 0.15, 0.3) * height)},
                     0.35F * r, 5, {Material::bark}));
  }
  for (int i = 0; i < 4; ++i) {
    const Vector3f centre(between(random, -0.1, 0.1) * height, between(random, -0.1, 0.1) * height,
                          between(random, 0.55, 0.78) * height);
    mesh.append(crown(centre, Vector3f(0.2F, 0.2F, 0.18F) * height, leaf_count / 4, 0.035F * height + 0.03F, random));
  }
  return mesh;
}

Mesh bush(float height, int leaf_count, Random& random) {
  Mesh mesh = crown({0.0F, 0.0F, 0.55F * height}, Vector3f(0.4F, 0.4F, 0.45F) * height, leaf_count,
                    0.07F * height + 0.02F, random);
  mesh.append(cylinder(0.03F * height, 0.5F * height, 6, {Material::bark}));
  return mesh;
}

Mesh car(Random& random) {
  // Cross-sections from tail to nose: x, half width, bottom, top of the body, half width and height of the cabin's roof
  // (0: none).
  const float tall = between(random, 0.0, 0.25);
  struct Section {
    float x, half, bottom, shoulder, roof_half, roof;
  };
  const std::array sections{Section{-2.15F, 0.70F, 0.45F, 0.75F, 0.65F, 0.75F},
                            Section{-2.05F, 0.84F, 0.25F, 0.92F, 0.70F, 0.93F},
                            Section{-1.55F, 0.88F, 0.20F, 0.93F, 0.60F, 1.32F + tall},
                            Section{-0.4F, 0.90F, 0.20F, 0.92F, 0.62F, 1.45F + tall},
                            Section{0.35F, 0.90F, 0.20F, 0.91F, 0.60F, 1.38F + tall},
                            Section{1.05F, 0.88F, 0.20F, 0.90F, 0.74F, 0.93F},
                            Section{1.95F, 0.84F, 0.22F, 0.76F, 0.70F, 0.78F},
                            Section{2.15F, 0.70F, 0.35F, 0.60F, 0.60F, 0.62F}};
  const Finish paint{Material::car_paint, between(random, -1.0, 3.0)}, glass{Material::car_glass};
  Mesh mesh;
  for (std::size_t i = 0; i + 1 < sections.size(); ++i) {
    const Section &a = sections[i], &b = sections[i + 1];
    const bool cabin = a.roof > 1.0F || b.roof > 1.0F;
    const auto strip = [&](const Vector3f& a0, const Vector3f& b0, const Vector3f& a1, const Vector3f& b1,
                           Finish finish) {
      Mesh quad = panel(a0, b0 - a0, a1 - a0, finish);
      quad.vertices[3] = b1;
      mesh.append(quad);
    };
    for (const float s : {-1.0F, 1.0F}) {
      strip({a.x, s * a.half, a.bottom}, {b.x, s * b.half, b.bottom}, {a.x, s * a.half, a.shoulder},
            {b.x, s * b.half, b.shoulder}, paint);
      strip({a.x, s * a.half, a.shoulder}, {b.x, s * b.half, b.shoulder}, {a.x, s * a.roof_half, a.roof},
            {b.x, s * b.roof_half, b.roof}, cabin ? glass : paint);
    }
    const bool screen = cabin && std::min(a.roof, b.roof) < 1.0F;
    strip({a.x, -a.roof_half, a.roof}, {b.x, -b.roof_half, b.roof}, {a.x, a.roof_half, a.roof},
          {b.x, b.roof_half, b.roof}, screen ? glass : paint);
    strip({a.x, -a.half, a.bottom}, {b.x, -b.half, b.bottom}, {a.x, a.half, a.bottom}, {b.x, b.half, b.bottom},
          {Material::dark_plastic, 4.0F});
  }
  for (const float x : {-1.3F, 1.35F})
    for (const float s : {-1.0F, 1.0F})
      mesh.append(tube(std::array{Vector3f(x, s * 0.7F, 0.32F), Vector3f(x, s * 0.91F, 0.32F)}, 0.32F, 14,
                       {Material::tyre, between(random, 0.0, 4.0)}));
  for (const float s : {-1.0F, 1.0F})
    mesh.append(at(box({0.05F, 0.3F, 0.12F}, {Material::light_plastic}), {2.1F, s * 0.55F, 0.6F}));
  mesh.append(at(box({0.02F, 0.5F, 0.11F}, {Material::sign_face}), {-2.15F, 0.0F, 0.55F}));
  return mesh;
}

Mesh person(Random& random) {
  const float h = between(random, 1.6, 1.9), stride = between(random, 0.15, 0.3);
  const auto limb = [](const Vector3f& a, const Vector3f& b, float r, Material material) {
    Mesh mesh = tube(std::array{a, b}, r, 8, {material});
    mesh.append(at(sphere(r, 8, {material}), a));
    mesh.append(at(sphere(r, 8, {material}), b));
    return mesh;
  };
  Mesh mesh;
  for (const float s : {-1.0F, 1.0F}) {
    mesh.append(limb({0.0F, s * 0.1F, 0.5F * h}, {s * 0.4F * stride, s * 0.1F, 0.27F * h}, 0.08F, Material::clothes));
    mesh.append(
        limb({s * 0.4F * stride, s * 0.1F, 0.27F * h}, {s * stride, s * 0.1F, 0.06F}, 0.06F, Material::clothes));
    mesh.append(limb({0.0F, s * 0.22F, 0.8F * h}, {-s * 0.1F, s * 0.26F, 0.62F * h}, 0.05F, Material::clothes));
    mesh.append(
        limb({-s * 0.1F, s * 0.26F, 0.62F * h}, {0.05F - s * 0.15F, s * 0.25F, 0.48F * h}, 0.04F, Material::skin));
  }
  const std::array torso{Vector2f(0.0F, 0.48F * h), Vector2f(0.15F, 0.5F * h),  Vector2f(0.14F, 0.62F * h),
                         Vector2f(0.18F, 0.8F * h), Vector2f(0.06F, 0.84F * h), Vector2f(0.05F, 0.87F * h)};
  mesh.append(lathe(torso, 12, {Material::clothes}));
  mesh.append(at(sphere(0.105F, 12, {Material::skin, 1.0F}), {0.0F, 0.0F, 0.93F * h}));
  return mesh;
}

Mesh street_lamp(float height) {
  const std::array profile{Vector2f(0.12F, 0.0F), Vector2f(0.12F, 0.8F), Vector2f(0.07F, 0.85F),
                           Vector2f(0.045F, height)};
  Mesh mesh = lathe(profile, 10, {Material::street_metal});
  mesh.append(tube(std::array{Vector3f(0.0F, 0.0F, height - 0.05F), Vector3f(0.5F, 0.0F, height + 0.15F),
                              Vector3f(1.4F, 0.0F, height + 0.2F)},
                   0.035F, 6, {Material::street_metal}));
  mesh.append(at(box({0.6F, 0.25F, 0.1F}, {Material::street_metal, 2.0F}), {1.6F, 0.0F, height + 0.15F}));
  mesh.append(at(box({0.5F, 0.2F, 0.03F}, {Material::lamp}), {1.6F, 0.0F, height + 0.12F}));
  return mesh;
}

Mesh sign(Random& random) {
  const float h = between(random, 2.3, 2.9);
  Mesh mesh = cylinder(0.035F, h, 8, {Material::galvanised});
  const int sides = random.uniform() < 0.5 ? 4 : 18;
  const Eigen::Isometry3f upright(Eigen::AngleAxisf(0.5F * kPi, Vector3f::UnitY()) *
                                  Eigen::AngleAxisf(0.25F * kPi, Vector3f::UnitZ()));
  mesh.append(at(moved(cylinder(0.32F, 0.01F, sides, {Material::sign_face}), upright), {0.04F, 0.0F, h - 0.35F}));
  return mesh;
}

Mesh bin(Random& random) {
  Mesh mesh = box({0.6F, 0.55F, 0.95F}, {Material::dark_plastic, between(random, -0.5, 1.0)});
  mesh.append(at(box({0.66F, 0.6F, 0.06F}, {Material::dark_plastic}), {0.0F, 0.0F, 0.95F}));
  for (const float y : {-0.2F, 0.2F}) mesh.append(at(sphere(0.1F, 8, {Material::tyre}), {-0.25F, y, 0.1F}));
  return mesh;
}

Mesh fence(float length, Random& random) {
  Mesh mesh;
  const int bars = std::max(2, static_cast<int>(length / 0.25F));
  const Material material = random.uniform() < 0.5 ? Material::wood : Material::street_metal;
  const float bar = material == Material::wood ? 0.1F : 0.025F;
  for (int i = 0; i < bars; ++i)
    mesh.append(at(box({0.025F, bar, between(random, 1.15, 1.2)}, {material}),
                   {0.0F, ((static_cast<float>(i) + 0.5F) / static_cast<float>(bars) - 0.5F) * length, 0.0F}));
  for (const float z : {0.3F, 0.95F}) mesh.append(at(box({0.04F, length, 0.06F}, {material}), {-0.03F, 0.0F, z}));
  return mesh;
}

Mesh house(const House& house, Random& random) {
  constexpr float kFoot = 1.0F;  // walls go on below the ground, which may slope
  const float height = house.storey * static_cast<float>(house.storeys) + 0.4F;
  const int columns = std::max(1, static_cast<int>(house.width / between(random, 2.2, 3.2)));
  const float pitch = house.width / static_cast<float>(columns), w = between(random, 0.4, 0.55) * pitch,
              h = between(random, 1.3, 1.8);
  const int door = static_cast<int>(random.uniform() * columns);
  std::vector<Hole> holes;
  Mesh mesh;
  for (int s = 0; s < house.storeys; ++s)
    for (int c = 0; c < columns; ++c) {
      const float y = (static_cast<float>(c) + 0.5F) * pitch - 0.5F * house.width,
                  z = 1.1F + house.storey * static_cast<float>(s);
      const bool is_door = s == 0 && c == door;
      holes.emplace_back(y - 0.5F * w, (is_door ? 0.1F : z) + kFoot, y + 0.5F * w, (is_door ? 2.3F : z + h) + kFoot);
      if (is_door)
        mesh.append(at(shapes::door(w, 2.2F), {-0.12F, y, 0.1F}));
      else
        mesh.append(at(window_of_house(w, h), {0.0F, y, z}));
      if (s > 0 && random.uniform() < 0.12) {
        mesh.append(at(box({1.1F, w + 0.8F, 0.15F}, {Material::concrete, -0.5F}), {0.55F, y, z - 1.15F}));
        mesh.append(railing(std::array{
            Vector3f(0.0F, y - 0.5F * w - 0.35F, z - 1.0F), Vector3f(1.05F, y - 0.5F * w - 0.35F, z - 1.0F),
            Vector3f(1.05F, y + 0.5F * w + 0.35F, z - 1.0F), Vector3f(0.0F, y + 0.5F * w + 0.35F, z - 1.0F)}));
      }
    }
  mesh.append(at(wall_with_holes(house.width, height + kFoot, holes, 0.12F, {house.wall, between(random, -0.5, 0.5)}),
                 {0.0F, 0.0F, -kFoot}));
  for (const float y : {-0.5F, 0.5F})
    mesh.append(
        panel({0.0F, y * house.width, -kFoot}, {-house.depth, 0.0F, 0.0F}, {0.0F, 0.0F, height + kFoot}, {house.wall}));
  mesh.append(panel({-house.depth, -0.5F * house.width, -kFoot}, {0.0F, house.width, 0.0F},
                    {0.0F, 0.0F, height + kFoot}, {house.wall}));
  mesh.append(at(box({0.1F, house.width, 0.5F}, {Material::facade_stone}), {0.05F, 0.0F, -0.2F}));
  mesh.append(at(box({0.3F, house.width, 0.2F}, {house.wall, -0.3F}), {0.1F, 0.0F, height - 0.2F}));
  mesh.append(roof(house.width, house.depth, height, between(random, 1.5, 3.5), house.wall));
  mesh.append(tube(std::array{Vector3f(0.08F, 0.48F * house.width, 0.0F), Vector3f(0.08F, 0.48F * house.width, height)},
                   0.05F, 6, {Material::galvanised}));
  for (int i = 0; i < 2; ++i)
    mesh.append(at(box({0.5F, 0.5F, 2.2F}, {Material::brick_wall, 3.0F}),
                   {-0.35F * house.depth, between(random, -0.4, 0.4) * house.width, height + 0.5F}));
  return mesh;
}

}  // namespace pllit::shapes
