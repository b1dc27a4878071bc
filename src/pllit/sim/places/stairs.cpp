#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "pllit/sim/places/corridor_shell.hpp"
#include "pllit/sim/places/generators.hpp"
#include "pllit/sim/places/stairs_way.hpp"

namespace pllit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;
using shapes::at;
using shapes::box;
using shapes::panel;
using stairs::kSlab_m;
using stairs::point;
using stairs::Station;

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
    if (static_cast<double>(i - first) * stairs::kStep_m <= 0.8) continue;
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

/// Where a corridor meets the well.
struct Opening {
  Vector2d from, to;
  double low_z, high_z;
};

/// The openings in a storey of a wall, in the frame of wall_with_holes().
std::vector<shapes::Hole> openings_in(const Side& side, double z, double height_m, std::span<const Opening> openings) {
  const Vector2d middle = 0.5 * (side.from + side.to), inward(std::cos(side.yaw), std::sin(side.yaw)),
                 along(-inward.y(), inward.x());
  std::vector<shapes::Hole> holes;
  for (const Opening& opening : openings) {
    if (std::abs((opening.from - middle).dot(inward)) > 0.01) continue;
    const double a = (opening.from - middle).dot(along), b = (opening.to - middle).dot(along);
    const double low = std::max(opening.low_z - z, 0.0), high = std::min(opening.high_z - z, height_m);
    if (high - low < 0.02) continue;
    holes.push_back(Eigen::Vector4d(std::min(a, b), low, std::max(a, b), high).cast<float>());
  }
  return holes;
}

/// Doors, radiators and signs on the walls that a landing touches, where no corridor opens.
void add_fixtures(const Landing& landing, const Eigen::AlignedBox2d& well, std::span<const Opening> openings,
                  SceneBuilder& scene, Random& random) {
  for (const Side& side : sides_of(well)) {
    if (!openings_in(side, landing.z, 2.0, openings).empty()) continue;
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

/// A wall of the well, storey by storey, with windows or pipes in it, lamps, and a riser pipe in its corner; where a
/// corridor opens there is nothing but the wall around it.
void add_wall(const Side& side, double top_z, std::span<const Opening> openings, SceneBuilder& scene, Random& random) {
  constexpr double kStorey_m = 3.0;
  const float width = static_cast<float>((side.to - side.from).norm());
  const Vector2d middle = 0.5 * (side.from + side.to), inward(std::cos(side.yaw), std::sin(side.yaw));
  const bool windows = width > 2.5F && random.uniform() < 0.6;
  bool opens = false;
  for (double z = 0.0; z < top_z; z += kStorey_m) {
    const float height = static_cast<float>(std::min(kStorey_m, top_z - z));
    const float y = static_cast<float>(random.uniform(-0.25, 0.25)) * width;
    const auto put = [&](const Mesh& mesh, float off, float aside, float up) {
      scene.add(at(at(mesh, {off, aside, up}), point(middle, z), side.yaw));
    };
    std::vector<shapes::Hole> holes = openings_in(side, z, static_cast<double>(height), openings);
    const float peak_K = static_cast<float>(random.uniform(0.5, 2.0));
    if (!holes.empty()) {
      opens = true;
      put(shapes::wall_with_holes(width, height, holes, 0.0F, {Material::plaster}), 0.0F, 0.0F, 0.0F);
      continue;
    }
    if (windows && height > 2.5F) holes.emplace_back(y - 0.5F, 1.0F, y + 0.5F, 2.2F);
    put(shapes::wall_with_holes(width, height, holes, 0.2F, {Material::plaster}), 0.0F, 0.0F, 0.0F);
    if (!holes.empty()) put(shapes::window(1.0F, 1.2F), -0.12F, y, 1.0F);
    put(shapes::heat_bleed(0.25F, height, peak_K, Material::plaster), 0.0F, -y, 0.5F * height);
    put(box({0.12F, 0.4F, 0.15F}, {Material::lamp}), 0.06F, -0.5F * y, std::min(2.35F, height - 0.2F));
  }
  if (opens) return;
  const Vector2d corner = side.from + 0.2 * (side.to - side.from).normalized() + 0.2 * inward;
  const Material pipe = random.uniform() < 0.5 ? Material::insulation : Material::cold_pipe;
  for (double z = 0.0; z + 1.0 < top_z; z += 2.0)
    scene.add(shapes::pipe(std::array{point(corner, z), point(corner, std::min(z + 2.0, top_z))}, 0.05F, {pipe}));
}

/// The part of the way that lies in the well.
std::pair<std::vector<Station>, std::vector<double>> within(const Eigen::AlignedBox2d& well,
                                                            const std::vector<Station>& way,
                                                            const std::vector<double>& treads) {
  std::pair<std::vector<Station>, std::vector<double>> part;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (!well.contains(way[i].p)) continue;
    part.first.push_back(way[i]);
    part.second.push_back(treads[i]);
  }
  return part;
}

/// What of a level way lies outside the well.
Eigen::AlignedBox2d outside_of(const Eigen::AlignedBox2d& well, std::span<const Station> level) {
  Eigen::AlignedBox2d outside;
  for (const Station& station : level)
    if (!well.contains(station.p)) outside.extend(station.p);
  return outside;
}

/// Whether it leaves along x and goes on for a while.
bool is_corridor(const Eigen::AlignedBox2d& well, const Eigen::AlignedBox2d& outside) {
  constexpr double kLeast_m = 2.0;
  if (outside.isEmpty() || outside.min().y() < well.min().y() || outside.max().y() > well.max().y()) return false;
  return std::max(well.min().x() - outside.min().x(), outside.max().x() - well.max().x()) > kLeast_m;
}

CorridorShell shell_of(const Eigen::AlignedBox2d& well, const Eigen::AlignedBox2d& outside, double floor_z,
                       double aside_m, Random& random) {
  const bool before = outside.center().x() < well.min().x();
  const double beyond_m = random.uniform(10.0, 30.0), half_m = aside_m - 0.1;
  CorridorShell shell{};
  shell.from_x = static_cast<float>(before ? outside.min().x() - beyond_m : well.max().x());
  shell.to_x = static_cast<float>(before ? well.min().x() : outside.max().x() + beyond_m);
  shell.low_y = static_cast<float>(outside.min().y() - half_m);
  shell.high_y = static_cast<float>(outside.max().y() + half_m);
  shell.height = static_cast<float>(random.uniform(2.5, 2.8));
  shell.floor_z = static_cast<float>(floor_z);
  shell.open_from = !before;
  shell.open_to = before;
  return shell;
}

Opening opening_of(const CorridorShell& shell) {
  const double x = static_cast<double>(shell.open_to ? shell.to_x : shell.from_x);
  return {{x, static_cast<double>(shell.low_y)},
          {x, static_cast<double>(shell.high_y)},
          static_cast<double>(shell.floor_z),
          static_cast<double>(shell.floor_z + shell.height)};
}

}  // namespace

Expected<PlaceParts> make_stairs(const PlaceConfig& config) {
  Random random(config.seed, 30);
  const Site site = site_on_slopes(config, main_yaw_rad(config.path_W));
  SceneBuilder scene(site);
  const double aside_m = site.clearance_m + random.uniform(0.4, 0.9);
  const double top_z = site.bounds_P.max().z() + site.clearance_m + random.uniform(0.8, 1.4);
  const auto way = stairs::stations_of(site);
  const auto treads = stairs::treads_of(way);
  const auto [first, last] = stairs::climb_of(way);
  Eigen::AlignedBox2d well;
  const auto take_in = [&](const Vector2d& p) {
    well.extend(Vector2d(p.array() - aside_m));
    well.extend(Vector2d(p.array() + aside_m));
  };
  for (std::size_t i = first; i <= last; ++i) take_in(way[i].p);
  const std::span<const Station> stations(way);
  const std::array levels{stations.first(first), stations.subspan(last + 1)};
  for (int twice = 0; twice < 2; ++twice)  // what one level way adds to the well may shorten the other
    for (const auto level : levels)
      if (!is_corridor(well, outside_of(well, level)))
        for (const Station& station : level) take_in(station.p);
  std::vector<Opening> openings;
  for (const std::size_t i : {0U, 1U}) {
    const auto outside = outside_of(well, levels[i]);
    if (outside.isEmpty()) continue;
    const CorridorShell shell = shell_of(well, outside, treads[i == 0 ? first : last], aside_m, random);
    add_corridor(shell, Relief::some, scene, random);
    openings.push_back(opening_of(shell));
  }

  const auto [climb, climb_treads] = within(well, way, treads);
  stairs::add_way(climb, climb_treads, site, scene);
  for (const Side& side : sides_of(well)) add_wall(side, top_z, openings, scene, random);
  for (const Landing& landing : landings_of(climb, climb_treads, well)) {
    add_landing(landing, scene);
    add_fixtures(landing, well, openings, scene, random);
  }
  const Vector3f x(static_cast<float>(well.sizes().x()), 0.0F, 0.0F),
      y(0.0F, static_cast<float>(well.sizes().y()), 0.0F);
  scene.add_ground(panel(point(well.min(), -0.4), x, y, {Material::screed}));
  scene.add(panel(point(well.min(), top_z), y, x, {Material::plaster}));
  return indoors(config, {}, scene);
}

}  // namespace pllit
