#include "pllit/sim/places/walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pllit {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using shapes::at;
using shapes::box;

constexpr double kThick_m = 0.14;
constexpr double kStep_m = 0.05;

struct Wall {
  Vector2d from, to;
  bool outer = false;
  Vector2d inward = Vector2d::Zero();  ///< of outer walls
};

struct Interval {
  double from, to;
};

/// Where along the wall the path needs room.
std::vector<Interval> openings(const Wall& wall, const Site& site) {
  const Vector2d along = (wall.to - wall.from).normalized();
  const double length_m = (wall.to - wall.from).norm(), reach_m = site.clearance_m + 0.5 * kThick_m + 0.1;
  std::vector<Interval> open;
  for (double s = 0.0; s <= length_m; s += kStep_m) {
    if (site.path_P.nearest(wall.from + s * along, reach_m).distance_m >= reach_m) continue;
    if (!open.empty() && s - open.back().to < 0.6)
      open.back().to = s + kStep_m;
    else
      open.push_back({std::max(0.0, s - kStep_m), s + kStep_m});
  }
  for (Interval& gap : open) gap.to = std::min(gap.to, length_m);
  return open;
}

double open_length_m(const Wall& wall, const Site& site) {
  double sum_m = 0.0;
  for (const Interval& gap : openings(wall, site)) sum_m += gap.to - gap.from;
  return sum_m;
}

Wall cut_across(const AlignedBox2d& room, int axis, double share) {
  const double at_m = room.min()[axis] + share * room.sizes()[axis];
  Vector2d from = room.min(), to = room.max();
  from[axis] = to[axis] = at_m;
  return {from, to};
}

/// Splits the room across its longer side where a wall costs the least opening, until rooms are small or walls would be
/// mostly open.
void cut_rooms(const AlignedBox2d& room, const Site& site, Random& random, std::vector<AlignedBox2d>& rooms,
               std::vector<Wall>& walls) {
  const int axis = room.sizes().x() >= room.sizes().y() ? 0 : 1;
  const double longest_m = room.sizes()[axis], wanted_m = random.uniform(4.5, 7.0);
  Wall best;
  double least_m = 1e9;
  for (int i = 0; i < 10; ++i) {
    const Wall wall = cut_across(room, axis, random.uniform(0.3, 0.7));
    const double open_m = open_length_m(wall, site);
    if (open_m < least_m) {
      least_m = open_m;
      best = wall;
    }
  }
  if (longest_m < wanted_m || least_m > 0.6 * (best.to - best.from).norm()) {
    rooms.push_back(room);
    return;
  }
  walls.push_back(best);
  cut_rooms({room.min(), best.to}, site, random, rooms, walls);
  cut_rooms({best.from, room.max()}, site, random, rooms, walls);
}

/// Windows on outer walls: {y0, z0, y1, z1} in the frame of the piece.
std::vector<shapes::Hole> window_holes(double length_m, Random& random) {
  std::vector<shapes::Hole> holes;
  const double pitch_m = random.uniform(2.2, 3.4), width_m = random.uniform(1.0, 1.6),
               height_m = random.uniform(1.1, 1.4);
  const int count = static_cast<int>(length_m / pitch_m);
  for (int i = 0; i < count; ++i) {
    const double y = ((i + 0.5) / count - 0.5) * length_m;
    holes.push_back(Eigen::Vector4d(y - 0.5 * width_m, 0.9, y + 0.5 * width_m, 0.9 + height_m).cast<float>());
  }
  return holes;
}

void add_outer_piece(const WallRun& run, double ceiling_m, SceneBuilder& scene, Random& random) {
  const auto holes = window_holes(run.length_m, random);
  const double middle_m = 0.5 * run.length_m;
  scene.add(on_run(shapes::wall_with_holes(static_cast<float>(run.length_m), static_cast<float>(ceiling_m), holes,
                                           0.25F, {run.material}),
                   run, middle_m, 0.0));
  const double sign =
      run.along.dot(Vector2d(-run.normal.y(), run.normal.x()));  // the mesh's y axis may run against the wall
  for (const shapes::Hole& h : holes) {
    const double s = middle_m + sign * 0.5 * (h[0] + h[2]);
    scene.add(on_run(shapes::window(h[2] - h[0], h[3] - h[1]), run, s, h[1], -0.15));
    scene.add(
        on_run(box({0.25F, h[2] - h[0] + 0.1F, 0.03F}, {Material::light_plastic, -1.0F}), run, s, h[1] - 0.03, 0.03));
    if (random.uniform() < 0.7) {
      const float warmer_K = static_cast<float>(random.uniform(-12.0, 12.0));
      scene.add(on_run(shapes::heat_bleed(1.5F, 1.3F, 2.5F + 0.1F * warmer_K, run.material), run, s, 0.62));
      scene.add(on_run(shapes::radiator(1.0F, 0.55F, warmer_K), run, s, 0.0, 0.1));
    }
  }
}

void add_inner_piece(const WallRun& run, double ceiling_m, FloorPlan& plan, SceneBuilder& scene) {
  const Vector2d middle = run.from + 0.5 * run.length_m * run.along - 0.5 * kThick_m * run.normal;
  scene.add(on_run(box({static_cast<float>(kThick_m), static_cast<float>(run.length_m), static_cast<float>(ceiling_m)},
                       {run.material}),
                   run, 0.5 * run.length_m, 0.0, -0.5 * kThick_m));
  const Vector2d size = run.length_m * run.along.cwiseAbs() + kThick_m * run.normal.cwiseAbs();
  plan.take(footprint(middle, size.x(), size.y()), ceiling_m);
}

void add_frame(const WallRun& run, const Interval& gap, double lintel_m, double ceiling_m, SceneBuilder& scene) {
  const float width = static_cast<float>(gap.to - gap.from);
  const auto put = [&](const Mesh& mesh, double s, double z) { scene.add(on_run(mesh, run, s, z, -0.5 * kThick_m)); };
  put(box({static_cast<float>(kThick_m), width, static_cast<float>(ceiling_m - lintel_m)}, {run.material}),
      0.5 * (gap.from + gap.to), lintel_m);
  put(box({0.2F, width, 0.06F}, {Material::door_frame}), 0.5 * (gap.from + gap.to), lintel_m - 0.06);
  for (const double s : {gap.from + 0.01, gap.to - 0.01})
    put(box({0.2F, 0.06F, static_cast<float>(lintel_m)}, {Material::door_frame}), s, 0.0);
  if (width < 1.9F)  // the leaf stands open against the wall
    put(at(shapes::door(0.9F, static_cast<float>(lintel_m)), {0.12F, 0.0F, 0.0F}), gap.to + 0.5, 0.0);
}

void add_wall(const Wall& wall, Floor& floor, FloorPlan& plan, SceneBuilder& scene, Random& random) {
  constexpr std::array kMaterials{Material::plaster, Material::paint_wall, Material::plaster, Material::brick_wall,
                                  Material::concrete};
  const Material material = kMaterials[static_cast<std::size_t>(random.uniform() * kMaterials.size())];
  const Vector2d along = (wall.to - wall.from).normalized();
  const double length_m = (wall.to - wall.from).norm();
  const Vector2d normal = wall.outer ? wall.inward : Vector2d(-along.y(), along.x());
  const double face_m = wall.outer ? 0.0 : 0.5 * kThick_m;
  const double top_m = plan.site().bounds_P.max().z() + plan.site().clearance_m + 0.12;
  const WallRun whole{wall.from + face_m * normal, along, length_m, normal, material, wall.outer};
  double done_m = 0.0;
  const auto add_solid = [&](double to_m) {
    if (to_m - done_m < 0.05) return;
    WallRun run = whole;
    run.from += done_m * along;
    run.length_m = to_m - done_m;
    floor.runs.push_back(run);
    if (wall.outer) return add_outer_piece(run, floor.ceiling_m, scene, random);
    add_inner_piece(run, floor.ceiling_m, plan, scene);
    run.from -= kThick_m * normal;
    run.normal = -normal;
    floor.runs.push_back(run);
  };
  for (const Interval& gap : openings(wall, plan.site())) {
    add_solid(gap.from);
    add_frame(whole, gap, std::max(2.1, top_m), floor.ceiling_m, scene);
    done_m = gap.to;
  }
  add_solid(length_m);
}

}  // namespace

Mesh on_run(const Mesh& mesh, const WallRun& run, double s, double z, double off) {
  const Vector2d p = run.from + s * run.along + off * run.normal;
  return at(mesh, Eigen::Vector3d(p.x(), p.y(), z).cast<float>(),
            static_cast<float>(std::atan2(run.normal.y(), run.normal.x())));
}

Floor add_floor_walls(const AlignedBox2d& box, double ceiling_m, FloorPlan& plan, SceneBuilder& scene, Random& random) {
  Floor floor{box, ceiling_m, {}, {}};
  const Vector2d a = box.min(), c = box.max(), b(c.x(), a.y()), d(a.x(), c.y());
  std::vector<Wall> walls{
      {a, b, true, {0.0, 1.0}}, {b, c, true, {-1.0, 0.0}}, {c, d, true, {0.0, -1.0}}, {d, a, true, {1.0, 0.0}}};
  cut_rooms(box, plan.site(), random, floor.rooms, walls);
  for (const Wall& wall : walls) add_wall(wall, floor, plan, scene, random);
  return floor;
}

}  // namespace pllit
