#include <algorithm>
#include <array>
#include <cmath>

#include "pllit/sim/places/generators.hpp"

namespace pllit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;
using shapes::at;
using shapes::box;
using shapes::panel;

constexpr double kStep_m = 0.1;  // between stations along the path
constexpr double kSmooth_m =
    0.6;  // half the window over which heights are averaged: steps of the walk vanish, flights stay
constexpr double kFlatSlope = 0.12;  // what rises less is a landing
constexpr double kRise_m = 0.17;
constexpr float kSlab_m = 0.16F;

struct Station {
  Vector2d p;
  Vector2d left;  ///< unit, at a right angle to the way
  double ground_z;
};

/// The way on the ground at even horizontal spacing, with smoothed heights: standing still or bobbing adds nothing.
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

/// Steps: a station's tread is at a whole number of rises; landings are as high as the path's mean there.
std::vector<double> treads_of(const std::vector<Station>& way) {
  std::vector<double> treads;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const std::size_t a = i >= 3 ? i - 3 : 0, b = std::min(i + 3, way.size() - 1);
    const double run_m = std::max(kStep_m, static_cast<double>(b - a) * kStep_m),
                 slope = (way[b].ground_z - way[a].ground_z) / run_m;
    const bool level = std::abs(slope) < kFlatSlope && !treads.empty();
    treads.push_back(level ? treads.back() : kRise_m * std::floor(way[i].ground_z / kRise_m));
  }
  return treads;
}

Vector3f point(const Vector2d& p, double z) { return Eigen::Vector3d(p.x(), p.y(), z).cast<float>(); }

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

struct Landing {
  Eigen::AlignedBox2d box;
  double z;
};

/// A square of floor around each level stretch of the way, within the well.
std::vector<Landing> landings_of(const std::vector<Station>& way, const std::vector<double>& treads,
                                 const Eigen::AlignedBox2d& well) {
  std::vector<Landing> landings;
  for (std::size_t i = 0; i < way.size();) {
    const std::size_t first = i;
    Eigen::AlignedBox2d level;
    while (i < way.size() && treads[i] == treads[first]) level.extend(way[i++].p);
    if (static_cast<double>(i - first) * kStep_m <= 0.8) continue;
    const Vector2d low = level.min().array() - 1.1, high = level.max().array() + 1.1;
    landings.push_back({{low.cwiseMax(well.min()), high.cwiseMin(well.max())}, treads[first]});
  }
  return landings;
}

/// In cells, so that a landing keeps what flights below and above leave free of it.
void add_landing(const Landing& landing, SceneBuilder& scene) {
  constexpr double kCell_m = 0.5;
  const Vector2d cells = (landing.box.sizes() / kCell_m).array().ceil(),
                 size = landing.box.sizes().cwiseQuotient(cells);
  const Eigen::Vector3d cell(size.x(), size.y(), static_cast<double>(kSlab_m));
  for (int x = 0; x < static_cast<int>(cells.x()); ++x)
    for (int y = 0; y < static_cast<int>(cells.y()); ++y) {
      const Vector2d middle = landing.box.min() + size.cwiseProduct(Vector2d(x + 0.5, y + 0.5));
      const double under_m = landing.z - static_cast<double>(kSlab_m) - 0.005;
      scene.add(at(box(cell.cast<float>(), {Material::floor_tiles}), point(middle, under_m)));
    }
}

struct Side {
  Vector2d from, to;
  float yaw;  ///< of the direction into the well
};

std::array<Side, 4> sides_of(const Eigen::AlignedBox2d& well) {
  const Vector2d a = well.min(), c = well.max(), b(c.x(), a.y()), d(a.x(), c.y());
  return {Side{a, b, 1.5707963F}, Side{b, c, 3.1415927F}, Side{c, d, -1.5707963F}, Side{d, a, 0.0F}};
}

/// Doors, radiators and signs on the walls that a landing touches.
void add_fixtures(const Landing& landing, const Eigen::AlignedBox2d& well, SceneBuilder& scene, Random& random) {
  for (const Side& side : sides_of(well)) {
    const Vector2d along = (side.to - side.from).normalized(), inward(std::cos(side.yaw), std::sin(side.yaw));
    const Vector2d foot = side.from + along.dot(landing.box.center() - side.from) * along;
    if (landing.box.exteriorDistance(foot) > 0.05) continue;
    const auto put = [&](const Mesh& mesh, double aside_m, double up_m, double off_m) {
      scene.add(at(mesh, point(foot + aside_m * along + off_m * inward, landing.z + up_m), side.yaw));
    };
    if (random.uniform() < 0.5) {
      put(shapes::door(0.9F, 2.1F), 0.0, 0.0, 0.03);
      put(box({0.03F, 0.35F, 0.25F}, {Material::sign_face}), 0.7, 1.5, 0.015);
    } else {
      put(shapes::heat_bleed(1.3F, 1.1F, 2.5F, Material::plaster), 0.0, 0.55, 0.0);
      put(shapes::radiator(0.8F, 0.5F, static_cast<float>(random.uniform(-8.0, 8.0))), 0.0, 0.0, 0.1);
    }
  }
}

/// A wall of the well, storey by storey, with windows or pipes in it, lamps, and a riser pipe in its corner.
void add_wall(const Side& side, double top_z, SceneBuilder& scene, Random& random) {
  constexpr double kStorey_m = 3.0;
  const float width = static_cast<float>((side.to - side.from).norm());
  const Vector2d middle = 0.5 * (side.from + side.to), inward(std::cos(side.yaw), std::sin(side.yaw));
  const bool windows = width > 2.5F && random.uniform() < 0.6;
  for (double z = 0.0; z < top_z; z += kStorey_m) {
    const float height = static_cast<float>(std::min(kStorey_m, top_z - z));
    const float y = static_cast<float>(random.uniform(-0.25, 0.25)) * width;
    const auto put = [&](const Mesh& mesh, float off, float aside, float up) {
      scene.add(at(at(mesh, {off, aside, up}), point(middle, z), side.yaw));
    };
    std::vector<shapes::Hole> holes;
    if (windows && height > 2.5F) holes.emplace_back(y - 0.5F, 1.0F, y + 0.5F, 2.2F);
    put(shapes::wall_with_holes(width, height, holes, 0.2F, {Material::plaster}), 0.0F, 0.0F, 0.0F);
    if (!holes.empty()) put(shapes::window(1.0F, 1.2F), -0.12F, y, 1.0F);
    const float peak_K = static_cast<float>(random.uniform(0.5, 2.0));
    put(shapes::heat_bleed(0.25F, height, peak_K, Material::plaster), 0.0F, -y, 0.5F * height);
    put(box({0.12F, 0.4F, 0.15F}, {Material::lamp}), 0.06F, -0.5F * y, std::min(2.35F, height - 0.2F));
  }
  const Vector2d corner = side.from + 0.2 * (side.to - side.from).normalized() + 0.2 * inward;
  const Material pipe = random.uniform() < 0.5 ? Material::insulation : Material::cold_pipe;
  for (double z = 0.0; z + 1.0 < top_z; z += 2.0)
    scene.add(shapes::pipe(std::array{point(corner, z), point(corner, std::min(z + 2.0, top_z))}, 0.05F, {pipe}));
}

}  // namespace

Expected<PlaceParts> make_stairs(const PlaceConfig& config) {
  Random random(config.seed, 30);
  const Site site = site_on_slopes(config, main_yaw_rad(config.path_W));
  SceneBuilder scene(site);
  const double aside_m = site.clearance_m + random.uniform(0.4, 0.9);
  const Vector2d low = site.bounds_P.min().head<2>().array() - aside_m,
                 high = site.bounds_P.max().head<2>().array() + aside_m;
  const double top_z = site.bounds_P.max().z() + site.clearance_m + random.uniform(0.8, 1.4);
  const Eigen::AlignedBox2d well(low, high);

  const auto way = stations_of(site);
  const auto treads = treads_of(way);
  add_way(way, treads, site, scene);
  for (const Side& side : sides_of(well)) add_wall(side, top_z, scene, random);
  for (const Landing& landing : landings_of(way, treads, well)) {
    add_landing(landing, scene);
    add_fixtures(landing, well, scene, random);
  }
  const Vector3f x(static_cast<float>(well.sizes().x()), 0.0F, 0.0F),
      y(0.0F, static_cast<float>(well.sizes().y()), 0.0F);
  scene.add_ground(panel(point(low, -0.4), x, y, {Material::screed}));
  scene.add(panel(point(low, top_z), y, x, {Material::plaster}));
  return indoors(config, {}, scene);
}

}  // namespace pllit
