#include "pllit/sim/camera/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pllit {
namespace {

using Eigen::Vector2f;

constexpr std::uint32_t kX = 0x8da6b343U, kY = 0xd8163841U, kZ = 0xcb1ab31fU, kSeed = 0x9e3779b9U;

/// Integer hash with low bias (Wellons, "Prospecting for hash functions", 2018).
std::uint32_t mixed(std::uint32_t h) {
  h = (h ^ (h >> 16)) * 0x7feb352dU;
  h = (h ^ (h >> 15)) * 0x846ca68bU;
  return h ^ (h >> 16);
}

std::uint32_t hash(int x, int y, int z, std::uint32_t seed) {
  return mixed(static_cast<std::uint32_t>(x) * kX + static_cast<std::uint32_t>(y) * kY +
               static_cast<std::uint32_t>(z) * kZ + seed * kSeed);
}

/// Uniform in [-1, 1).
float signed_unit(std::uint32_t bits) { return static_cast<float>(static_cast<std::int32_t>(bits)) * 0x1p-31F; }

float eased(float t) { return t * t * (3.0F - 2.0F * t); }

/// Random numbers on the integer lattice, smoothly interpolated: in [-1, 1], mean 0, continuous with its first
/// derivative.
float value_noise(const Vector3f& p, std::uint32_t seed) {
  const float fx = std::floor(p.x()), fy = std::floor(p.y()), fz = std::floor(p.z());
  const int x = static_cast<int>(fx), y = static_cast<int>(fy), z = static_cast<int>(fz);
  const float tx = eased(p.x() - fx), ty = eased(p.y() - fy), tz = eased(p.z() - fz);
  const std::uint32_t first = static_cast<std::uint32_t>(x) * kX + static_cast<std::uint32_t>(y) * kY +
                              static_cast<std::uint32_t>(z) * kZ + seed * kSeed;
  // Plain loops over eight numbers, which compilers turn into vector instructions.
  std::array<std::uint32_t, 8> bits{0, kX, kY, kX + kY, kZ, kZ + kX, kZ + kY, kZ + kX + kY};
  for (std::uint32_t& corner : bits) corner = mixed(first + corner);
  std::array<float, 8> corner;
  for (std::size_t i = 0; i < 8; ++i) corner[i] = signed_unit(bits[i]);
  std::array<float, 4> along_x;
  for (std::size_t i = 0; i < 4; ++i) along_x[i] = corner[2 * i] + tx * (corner[2 * i + 1] - corner[2 * i]);
  const float low = along_x[0] + ty * (along_x[1] - along_x[0]), high = along_x[2] + ty * (along_x[3] - along_x[2]);
  return low + tz * (high - low);
}

/// 1 where a feature is wider than two footprints, 0 where it is narrower than half of one.
float visibility(float feature_m, float footprint_m) {
  return std::clamp((feature_m / std::max(footprint_m, 1e-6F) - 0.5F) / 1.5F, 0.0F, 1.0F);
}

/// Stretches values that crowd around 0 over [-1, 1].
float stretched(float value) { return value * (1.5F - 0.5F * value * value); }

float clouds(const Texture& texture, const Vector3f& p, float footprint_m) {
  float sum = 0.0F, frequency = 2.0F / texture.scale_m, share = 0.6F;
  for (std::uint32_t octave = 0; octave < 3; ++octave, frequency *= 2.7F, share *= 0.45F) {
    const float visible = visibility(1.0F / frequency, footprint_m);
    if (visible <= 0.0F) break;
    sum += visible * share * value_noise(p * frequency, texture.seed + 7919U * octave);
  }
  return stretched(std::clamp(1.1F * sum, -1.0F, 1.0F));
}

/// Coordinates in the surface's plane, in metres: along the ground's axes on floors, else horizontal and up the wall.
Vector2f in_plane(const Vector3f& p, const Vector3f& normal) {
  if (std::abs(normal.z()) > 0.9F) return p.head<2>();
  const Vector3f across = Vector3f(-normal.y(), normal.x(), 0.0F).normalized();
  return {p.dot(across), p.dot(normal.cross(across))};
}

/// Cells of a lattice separated by joints, in units of the cell.
struct Lattice {
  float length, height, joint;  ///< of one cell and between them, in units of the texture's scale
  float shift;                  ///< of every other row, in lengths
  float variety;                ///< half the range of the cells' own values
};

float lattice(const Texture& texture, const Lattice& lattice, const Vector2f& uv_m, float footprint_m) {
  const float v = uv_m.y() / (texture.scale_m * lattice.height);
  const float row = std::floor(v);
  const float shift = lattice.shift * (std::fmod(std::abs(row), 2.0F) +
                                       0.31F * signed_unit(hash(static_cast<int>(row), 1, 2, texture.seed)));
  const float u = uv_m.x() / (texture.scale_m * lattice.length) + shift;
  const float column = std::floor(u);
  const float joint_u = lattice.joint / lattice.length, joint_v = lattice.joint / lattice.height;
  const float joints = 1.0F - (1.0F - joint_u) * (1.0F - joint_v);  // share of the area
  const bool in_joint = u - column < joint_u || v - row < joint_v;
  const float own =
      lattice.variety * signed_unit(hash(static_cast<int>(column), static_cast<int>(row), 3, texture.seed));
  const float seen = visibility(lattice.height * texture.scale_m, footprint_m);
  const float cell = joints / (1.0F - joints) + own * seen;
  const float joint_seen = visibility(lattice.joint * texture.scale_m, 0.25F * footprint_m);
  const float without_joints = own * seen;
  return (1.0F - joint_seen) * without_joints + joint_seen * (in_joint ? -1.0F : cell);
}

float planks(const Texture& texture, const Vector2f& uv_m, float footprint_m) {
  const float board = lattice(texture, {1.0F, 0.12F, 0.006F, 0.37F, 0.5F}, uv_m, footprint_m);
  const float width_m = 0.03F * texture.scale_m;
  const Vector3f grain(uv_m.x() / (12.0F * width_m), uv_m.y() / width_m, 0.0F);
  return std::clamp(board + 0.3F * visibility(width_m, footprint_m) * value_noise(grain, texture.seed + 1), -1.0F,
                    1.0F);
}

/// One round grain, dark or light, wholly inside each cell, so that a place has one cell to look into. The cells lie
/// askew, so that no wall or floor runs between them.
float speckle(const Texture& texture, const Vector3f& p, float footprint_m) {
  const Vector3f x(0.742F, 0.557F, 0.371F), y(-0.600F, 0.800F, 0.0F);
  const Vector3f q = Vector3f(p.dot(x), p.dot(y), p.dot(x.cross(y))) / texture.scale_m;
  const Vector3f cell = q.array().floor();
  const std::uint32_t bits =
      hash(static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z()), texture.seed);
  const std::uint32_t more = mixed(bits ^ 0x68bc21ebU);
  const float radius = 0.25F + 0.2F * static_cast<float>(more & 0xff) / 255.0F;
  const float slack = 0.5F - radius;
  const Vector3f centre =
      Vector3f::Constant(0.5F) + slack * Vector3f(static_cast<float>(bits & 0xff) / 127.5F - 1.0F,
                                                  static_cast<float>((bits >> 8) & 0xff) / 127.5F - 1.0F,
                                                  static_cast<float>((bits >> 16) & 0xff) / 127.5F - 1.0F);
  const bool inside = (q - cell - centre).squaredNorm() < radius * radius;
  return inside ? visibility(texture.scale_m, footprint_m) * signed_unit(more) : 0.0F;
}

float stains(const Texture& texture, const Vector3f& p, float footprint_m) {
  const Vector3f q = p * (2.0F / texture.scale_m);
  const float noise = value_noise(q, texture.seed) + 0.25F * value_noise(q * 3.1F, texture.seed + 1);
  // The noise changes by about this within a footprint.
  const float within = 3.0F * footprint_m / texture.scale_m;
  constexpr float threshold = 0.32F, edge = 0.015F;
  const float inside = std::clamp((std::abs(noise) - threshold) / std::max(edge, within) + 0.5F, 0.0F, 1.0F);
  return visibility(0.5F * texture.scale_m, footprint_m) * std::copysign(inside, noise);
}

/// Wavy lines, one in each strip of the scale's width, half of all textures upright.
float wires(const Texture& texture, const Vector2f& uv_m, float footprint_m) {
  const bool upright = (mixed(texture.seed) & 1U) != 0;
  const float along = (upright ? uv_m.y() : uv_m.x()) / texture.scale_m,
              across = (upright ? uv_m.x() : uv_m.y()) / texture.scale_m;
  const float strip = std::floor(across);
  const float place = 0.5F + 0.25F * signed_unit(hash(static_cast<int>(strip), 5, 7, texture.seed)) +
                      0.15F * value_noise({0.5F * along, 17.0F * strip, 0.0F}, texture.seed);
  constexpr float width = 0.04F;
  const float seen = visibility(width * texture.scale_m, 0.25F * footprint_m);
  return seen * ((std::abs(across - strip - place) < 0.5F * width ? 1.0F : 0.0F) - width) / (1.0F - width);
}

}  // namespace

float texture_value(const Texture& texture, const Vector3f& p_own, const Vector3f& normal_own, float footprint_m) {
  using Kind = Texture::Kind;
  switch (texture.kind) {
    case Kind::plain:
      return 0.0F;
    case Kind::clouds:
      return clouds(texture, p_own, footprint_m);
    case Kind::speckle:
      return speckle(texture, p_own, footprint_m);
    case Kind::stains:
      return stains(texture, p_own, footprint_m);
    default:
      break;
  }
  const Vector2f uv_m = in_plane(p_own, normal_own);
  switch (texture.kind) {
    case Kind::bricks:
      return lattice(texture, {1.0F, 0.3F, 0.045F, 0.5F, 0.5F}, uv_m, footprint_m);
    case Kind::tiles:
      return lattice(texture, {1.0F, 1.0F, 0.025F, 0.0F, 0.4F}, uv_m, footprint_m);
    case Kind::planks:
      return planks(texture, uv_m, footprint_m);
    default:
      return wires(texture, uv_m, footprint_m);
  }
}

}  // namespace pllit
