#include "pllit/sim/places/shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace pllit::shapes {
namespace {

constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, Finish finish) {
  mesh.triangles.push_back({a, b, c});
  mesh.surface.push_back(static_cast<std::uint32_t>(finish.material));
  mesh.warmer_K.push_back(finish.warmer_K);
}

void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, Finish finish) {
  add_triangle(mesh, a, b, c, finish);
  add_triangle(mesh, a, c, d, finish);
}

/// Joins ring after ring of `sides` vertices each, starting with the mesh's first.
void skin_rings(Mesh& mesh, std::uint32_t rings, std::uint32_t sides, Finish finish) {
  for (std::uint32_t r = 0; r + 1 < rings; ++r)
    for (std::uint32_t i = 0; i < sides; ++i) {
      const std::uint32_t j = (i + 1) % sides, low = r * sides, high = low + sides;
      add_quad(mesh, low + i, low + j, high + j, high + i, finish);
    }
}

/// Any unit vector at a right angle to a.
Vector3f beside(const Vector3f& a) {
  return a.cross(std::abs(a.z()) < 0.8F ? Vector3f::UnitZ() : Vector3f::UnitX()).normalized();
}

/// The polyline with each corner replaced by an arc of radius at most `bend`.
std::vector<Vector3f> rounded(std::span<const Vector3f> line, float bend) {
  std::vector<Vector3f> smooth{line.front()};
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    const Vector3f in = line[i] - line[i - 1], out = line[i + 1] - line[i];
    const float cut = std::min({bend, 0.45F * in.norm(), 0.45F * out.norm()});
    const Vector3f a = line[i] - cut * in.normalized(), b = line[i] + cut * out.normalized();
    for (int k = 0; k <= 4; ++k) {  // a quadratic Bezier arc
      const float t = 0.25F * static_cast<float>(k);
      smooth.push_back((1.0F - t) * (1.0F - t) * a + 2.0F * t * (1.0F - t) * line[i] + t * t * b);
    }
  }
  smooth.push_back(line.back());
  return smooth;
}

std::vector<float> cuts(std::span<const Hole> holes, int low, int high, float from, float to) {
  std::vector<float> values{from, to};
  for (const Hole& hole : holes) values.insert(values.end(), {hole[low], hole[high]});
  std::ranges::sort(values);
  const auto same = std::ranges::unique(values, [](float a, float b) { return b - a < 1e-4F; });
  values.erase(same.begin(), same.end());
  return values;
}

}  // namespace

Mesh moved(Mesh mesh, const Eigen::Isometry3f& T_to_from) {
  for (Vector3f& v : mesh.vertices) v = T_to_from * v;
  return mesh;
}

Mesh at(Mesh mesh, const Vector3f& p, float yaw_rad) {
  return moved(std::move(mesh),
               Eigen::Translation3f(p) * Eigen::AngleAxisf(yaw_rad, Vector3f::UnitZ()) * Eigen::Isometry3f::Identity());
}

Mesh panel(const Vector3f& corner, const Vector3f& u, const Vector3f& v, Finish finish, int nu, int nv) {
  Mesh mesh;
  const auto columns = static_cast<std::uint32_t>(nu) + 1;
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i <= nu; ++i)
      mesh.vertices.push_back(corner + u * (static_cast<float>(i) / static_cast<float>(nu)) +
                              v * (static_cast<float>(j) / static_cast<float>(nv)));
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(nv); ++j)
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = j * columns + i;
      add_quad(mesh, a, a + 1, a + 1 + columns, a + columns, finish);
    }
  return mesh;
}

Mesh box(const Vector3f& size, Finish finish) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1 ? 0.5F : -0.5F) * size.x(), (i & 2 ? 0.5F : -0.5F) * size.y(),
                               i & 4 ? size.z() : 0.0F);
  add_quad(mesh, 0, 2, 3, 1, finish);
  add_quad(mesh, 4, 5, 7, 6, finish);
  add_quad(mesh, 0, 1, 5, 4, finish);
  add_quad(mesh, 2, 6, 7, 3, finish);
  add_quad(mesh, 0, 4, 6, 2, finish);
  add_quad(mesh, 1, 3, 7, 5, finish);
  return mesh;
}

Mesh lathe(std::span<const Vector2f> profile, int sides, Finish finish) {
  Mesh mesh;
  for (const Vector2f& p : profile)
    for (int i = 0; i < sides; ++i) {
      const float angle = kTurn * static_cast<float>(i) / static_cast<float>(sides);
      mesh.vertices.emplace_back(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
    }
  skin_rings(mesh, static_cast<std::uint32_t>(profile.size()), static_cast<std::uint32_t>(sides), finish);
  return mesh;
}

Mesh cylinder(float radius, float height, int sides, Finish finish) {
  return lathe(
      std::array{Vector2f(0.0F, 0.0F), Vector2f(radius, 0.0F), Vector2f(radius, height), Vector2f(0.0F, height)}, sides,
      finish);
}

Mesh sphere(float radius, int sides, Finish finish) {
  std::vector<Vector2f> profile;
  const int rings = std::max(4, sides / 2);
  for (int i = 0; i <= rings; ++i) {
    const float angle = 0.5F * kTurn * static_cast<float>(i) / static_cast<float>(rings);
    profile.emplace_back(radius * std::sin(angle), -radius * std::cos(angle));
  }
  return lathe(profile, sides, finish);
}

Mesh tube(std::span<const Vector3f> line, float radius, int sides, Finish finish) {
  Mesh mesh;
  Vector3f side = beside((line[1] - line[0]).normalized());
  for (std::size_t k = 0; k < line.size(); ++k) {
    const Vector3f in = (line[std::max<std::size_t>(k, 1)] - line[std::max<std::size_t>(k, 1) - 1]).normalized();
    const Vector3f out = k + 1 < line.size() ? Vector3f((line[k + 1] - line[k]).normalized()) : in;
    const Vector3f along = (in + out).squaredNorm() > 1e-6F ? Vector3f((in + out).normalized()) : in;
    // The mitre is wider than the pipe across the bend; 2 bounds it for sharp corners.
    const float stretch = std::min(2.0F, 1.0F / std::max(0.1F, along.dot(in)));
    const Vector3f bend = (out - in).squaredNorm() > 1e-6F ? Vector3f((out - in).normalized()) : Vector3f::Zero();
    side = (side - side.dot(along) * along);
    side = side.squaredNorm() > 1e-6F ? Vector3f(side.normalized()) : beside(along);
    const Vector3f up = along.cross(side);
    for (int i = 0; i < sides; ++i) {
      const float angle = kTurn * static_cast<float>(i) / static_cast<float>(sides);
      const Vector3f d = radius * (std::cos(angle) * side + std::sin(angle) * up);
      mesh.vertices.push_back(line[k] + d + (stretch - 1.0F) * d.dot(bend) * bend);
    }
  }
  const auto n = static_cast<std::uint32_t>(sides), rings = static_cast<std::uint32_t>(line.size());
  skin_rings(mesh, rings, n, finish);
  for (std::uint32_t i = 1; i + 1 < n; ++i) {
    add_triangle(mesh, 0, i + 1, i, finish);
    add_triangle(mesh, (rings - 1) * n, (rings - 1) * n + i, (rings - 1) * n + i + 1, finish);
  }
  return mesh;
}

Mesh pipe(std::span<const Vector3f> line, float radius, Finish finish) {
  const std::vector<Vector3f> smooth = rounded(line, 3.0F * radius);
  Mesh mesh = tube(smooth, radius, 10, finish);
  const auto add_flange = [&](const Vector3f& centre, const Vector3f& along) {
    const Vector3f half = 0.25F * radius * along.normalized();
    mesh.append(tube(std::array{Vector3f(centre - half), Vector3f(centre + half)}, 1.35F * radius, 10, finish));
  };
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector3f along = line[i + 1] - line[i];
    if (along.norm() < 12.0F * radius) continue;
    add_flange(line[i] + 4.0F * radius * along.normalized(), along);
    add_flange(line[i + 1] - 4.0F * radius * along.normalized(), along);
  }
  return mesh;
}

Mesh cable(const Vector3f& from, const Vector3f& to, float sag, float radius) {
  std::vector<Vector3f> line;
  constexpr int kPieces = 10;
  for (int i = 0; i <= kPieces; ++i) {
    const float t = static_cast<float>(i) / kPieces;  // a parabola: as good as a catenary for small sags
    line.push_back(from + t * (to - from) - 4.0F * sag * t * (1.0F - t) * Vector3f::UnitZ());
  }
  return tube(line, radius, 5, {Material::cable});
}

Mesh wall_with_holes(float width, float height, std::span<const Hole> holes, float depth, Finish finish) {
  const auto ys = cuts(holes, 0, 2, -0.5F * width, 0.5F * width), zs = cuts(holes, 1, 3, 0.0F, height);
  Mesh mesh;
  for (std::size_t j = 0; j + 1 < zs.size(); ++j)
    for (std::size_t i = 0; i + 1 < ys.size(); ++i) {
      const float y = 0.5F * (ys[i] + ys[i + 1]), z = 0.5F * (zs[j] + zs[j + 1]);
      const auto inside = [&](const Hole& h) { return y > h[0] && y < h[2] && z > h[1] && z < h[3]; };
      if (std::ranges::any_of(holes, inside)) continue;
      mesh.append(
          panel({0.0F, ys[i], zs[j]}, {0.0F, ys[i + 1] - ys[i], 0.0F}, {0.0F, 0.0F, zs[j + 1] - zs[j]}, finish));
    }
  const Vector3f in = -depth * Vector3f::UnitX();
  for (const Hole& h : holes) {
    const Vector3f y(0.0F, h[2] - h[0], 0.0F), z(0.0F, 0.0F, h[3] - h[1]), low(0.0F, h[0], h[1]),
        high(0.0F, h[2], h[3]);
    for (const Mesh& reveal : {panel(low, y, in, finish), panel(low, in, z, finish), panel(high, in, -y, finish),
                               panel(high, -z, in, finish)})
      mesh.append(reveal);
  }
  return mesh;
}

Mesh heat_bleed(float width, float height, float peak_K, Material wall) {
  Mesh mesh;
  const int columns = std::clamp(static_cast<int>(width / 0.08F), 6, 16);
  const int rows = std::clamp(static_cast<int>(height / 0.12F), 6, 20);
  const float dy = width / static_cast<float>(columns), dz = height / static_cast<float>(rows);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const float y = (static_cast<float>(i) + 0.5F) * dy - 0.5F * width,
                  z = (static_cast<float>(j) + 0.5F) * dz - 0.5F * height;
      const float warmth = peak_K * std::exp(-5.0F * (y * y / (width * width) + z * z / (height * height)) * 2.0F);
      mesh.append(panel({0.002F, y - 0.5F * dy, z - 0.5F * dz}, {0.0F, dy, 0.0F}, {0.0F, 0.0F, dz}, {wall, warmth}));
    }
  return mesh;
}

}  // namespace pllit::shapes
