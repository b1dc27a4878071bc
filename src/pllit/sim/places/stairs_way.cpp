#include "pllit/sim/places/stairs_way.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pllit::stairs {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;
using shapes::panel;

constexpr double kSmooth_m =
    0.6;  // half the window over which heights are averaged: steps of the walk vanish, flights stay
constexpr double kFlatSlope = 0.12;  // what rises less is a landing
constexpr double kRise_m = 0.17;
constexpr double kSlack_m = 0.02;  // that the ground may lie below a step and still be on it

/// How steeply the way rises around a station.
double slope_at(const std::vector<Station>& way, std::size_t i) {
  const std::size_t a = i >= 3 ? i - 3 : 0, b = std::min(i + 3, way.size() - 1);
  return (way[b].ground_z - way[a].ground_z) / std::max(kStep_m, static_cast<double>(b - a) * kStep_m);
}

/// A quad through four corners.
Mesh quad(const Vector3f& a, const Vector3f& b, const Vector3f& c, const Vector3f& d, shapes::Finish finish) {
  Mesh mesh = panel(a, b - a, d - a, finish);
  mesh.vertices[3] = c;
  return mesh;
}

/// One tread from station i to the next, the riser before it, and the slab's underside.
Mesh tread(const Station& a, const Station& b, double z, double next_z, double half_width_m) {
  const Vector2d al = a.p + half_width_m * a.left, ar = a.p - half_width_m * a.left, bl = b.p + half_width_m * b.left,
                 br = b.p - half_width_m * b.left;
  const shapes::Finish top{Material::screed, -0.4F};
  Mesh mesh = quad(point(ar, z), point(br, z), point(bl, z), point(al, z), top);
  if (std::abs(next_z - z) > 0.01)
    mesh.append(quad(point(br, z), point(bl, z), point(bl, next_z), point(br, next_z), {Material::floor_tiles, 0.3F}));
  const double under = std::min(z, next_z) - kSlab_m;
  mesh.append(quad(point(ar, under), point(al, under), point(bl, under), point(br, under), {Material::screed}));
  for (const auto& [p, q] : {std::pair(al, bl), std::pair(ar, br)})
    mesh.append(quad(point(p, under), point(q, under), point(q, z), point(p, z), {Material::screed}));
  return mesh;
}

}  // namespace

std::vector<Station> stations_of(const Site& site) {
  std::vector<Station> way;
  for (const Vector3d& p : site.path_P.points()) {
    if (!way.empty() && (p.head<2>() - way.back().p).norm() < kStep_m) continue;
    way.push_back({p.head<2>(), Vector2d::Zero(), p.z() - site.height_m});
  }
  const auto half = static_cast<std::ptrdiff_t>(kSmooth_m / kStep_m), n = static_cast<std::ptrdiff_t>(way.size());
  std::vector<Station> smooth = way;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t reach = std::min({half, i, n - 1 - i});
    double sum = 0.0;
    for (std::ptrdiff_t k = -reach; k <= reach; ++k) sum += way[static_cast<std::size_t>(i + k)].ground_z;
    auto& s = smooth[static_cast<std::size_t>(i)];
    s.ground_z = sum / static_cast<double>(2 * reach + 1);
    const Vector2d along = way[static_cast<std::size_t>(std::min(i + 3, n - 1))].p -
                           way[static_cast<std::size_t>(std::max<std::ptrdiff_t>(i - 3, 0))].p;
    s.left = along.norm() > 1e-9 ? Vector2d(Vector2d(-along.y(), along.x()).normalized()) : Vector2d::UnitY();
  }
  return smooth;
}

std::vector<double> treads_of(const std::vector<Station>& way) {
  std::vector<double> treads;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const bool level = std::abs(slope_at(way, i)) < kFlatSlope && !treads.empty();
    treads.push_back(level ? treads.back() : kRise_m * std::floor((way[i].ground_z + kSlack_m) / kRise_m));
  }
  return treads;
}

std::pair<std::size_t, std::size_t> climb_of(const std::vector<Station>& way) {
  constexpr std::size_t kLanding = 12;
  std::size_t first = way.size() - 1, last = 0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (std::abs(slope_at(way, i)) < kFlatSlope) continue;
    first = std::min(first, i);
    last = i;
  }
  if (first > last) return {0, way.size() - 1};
  return {first - std::min(first, kLanding), std::min(last + kLanding, way.size() - 1)};
}

void add_way(const std::vector<Station>& way, const std::vector<double>& treads, const Site& site,
             SceneBuilder& scene) {
  const double half_m = site.clearance_m + 0.12;
  for (std::size_t i = 0; i + 1 < way.size(); ++i)
    scene.add_ground(tread(way[i], way[i + 1], treads[i], treads[i + 1], half_m));
  for (const double side : {-1.0, 1.0})
    for (std::size_t i = 0; i + 6 < way.size(); i += 6) {
      const std::array foot{point(way[i].p + side * half_m * way[i].left, treads[i]),
                            point(way[i + 6].p + side * half_m * way[i + 6].left, treads[i + 6])};
      if ((foot[1] - foot[0]).head<2>().norm() > 0.15F)
        scene.add(shapes::railing(foot));  // the inside of a turn has none
    }
}

}  // namespace pllit::stairs
