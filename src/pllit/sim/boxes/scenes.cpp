#include "pllit/sim/boxes/scenes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

/// An upright box: its bottom face, which nothing sees, is left out.
struct Box {
  Vector3d base_center_W;  ///< middle of the bottom face
  Vector3d size_m;
  double yaw_rad = 0.0;
};

void add_box(std::vector<Rectangle>& world, const Box& box, double reflectivity) {
  const Eigen::AngleAxisd turn(box.yaw_rad, Vector3d::UnitZ());
  const Vector3d x = turn * Vector3d(0.5 * box.size_m.x(), 0.0, 0.0);
  const Vector3d y = turn * Vector3d(0.0, 0.5 * box.size_m.y(), 0.0);
  const Vector3d z(0.0, 0.0, 0.5 * box.size_m.z());
  const Vector3d center = box.base_center_W + z;
  for (const double side : {-1.0, 1.0}) {
    world.push_back({center + side * x, y, z, reflectivity});
    world.push_back({center + side * y, x, z, reflectivity});
  }
  world.push_back({center + z, x, y, reflectivity});
}

double random_reflectivity(Random& random) { return random.uniform(0.2, 0.9); }

Vector3d random_size(const Vector3d& low, const Vector3d& high, Random& random) {
  const double x = random.uniform(low.x(), high.x()), y = random.uniform(low.y(), high.y());
  return {x, y, random.uniform(low.z(), high.z())};
}

/// Floor, ceiling and four walls; half_m is half the room, its floor at z = 0.
void add_shell(std::vector<Rectangle>& world, const Vector3d& half_m, Random& random) {
  const Vector3d x(half_m.x(), 0, 0), y(0, half_m.y(), 0), z(0, 0, half_m.z());
  for (const double side : {-1.0, 1.0}) {
    world.push_back({z + side * x, y, z, random_reflectivity(random)});
    world.push_back({z + side * y, x, z, random_reflectivity(random)});
    world.push_back({z + side * z, x, y, random_reflectivity(random)});
  }
}

/// A shelf, a table or a stub wall with its back at a wall of the room, at most 1.6 m deep (along y).
Vector3d random_furniture_size(double room_height_m, Random& random) {
  const double kind = random.uniform();
  if (kind < 0.4) return random_size({1.0, 0.4, 1.5}, {2.4, 0.7, 2.4}, random);
  if (kind < 0.7) return random_size({1.2, 0.7, 0.7}, {2.0, 1.0, 0.8}, random);
  const Vector3d stub = random_size({0.12, 1.2, 1.0}, {0.2, 1.6, 1.0}, random);
  return {stub.x(), stub.y(), room_height_m};
}

void add_furniture_along_walls(std::vector<Rectangle>& world, const Vector3d& half_m, Random& random) {
  for (const double side : {-1.0, 1.0}) {
    for (const double slot_x : {-5.5, 0.0, 5.5}) {
      const Vector3d size = random_furniture_size(2.0 * half_m.z(), random);
      const double x = slot_x + random.uniform(-1.0, 1.0);
      add_box(world, {{x, side * (half_m.y() - 0.5 * size.y()), 0.0}, size}, random_reflectivity(random));
    }
    for (const double slot_y : {-2.5, 2.5}) {
      const Vector3d size = random_size({0.4, 0.8, 0.7}, {0.8, 2.0, 2.2}, random);
      const double y = slot_y + random.uniform(-0.8, 0.8);
      add_box(world, {{side * (half_m.x() - 0.5 * size.x()), y, 0.0}, size}, random_reflectivity(random));
    }
  }
}

void add_ramp(std::vector<Rectangle>& world, const Vector3d& foot_center_W, Random& random) {
  const Vector3d half_size = random_size({0.9, 0.6, 0.25}, {1.2, 0.8, 0.45}, random);
  const Vector3d up(half_size.x(), 0.0, half_size.z()), across(0.0, half_size.y(), 0.0), rise(0.0, 0.0, half_size.z());
  const Vector3d middle = foot_center_W + rise;
  world.push_back({middle, up, across, random_reflectivity(random)});
  world.push_back({middle + Vector3d(half_size.x(), 0.0, 0.0), across, rise, random_reflectivity(random)});
}

/// A partition, a table with something on it, and a ramp, in a random order, within |x| < 3.9 m and |y| < 1.9 m.
void add_middle(std::vector<Rectangle>& world, Random& random) {
  std::array<double, 3> cells_x{-2.5, 0.0, 2.5};
  for (std::size_t i = 2; i > 0; --i) std::swap(cells_x[i], cells_x[random.bits() % (i + 1)]);
  const auto somewhere_in = [&](double cell_x) {
    const double dx = random.uniform(-0.25, 0.25);
    return Vector3d(cell_x + dx, random.uniform(-0.7, 0.7), 0.0);
  };
  const Vector3d partition_at = somewhere_in(cells_x[0]);
  const Vector3d partition = random_size({1.6, 0.1, 2.0}, {2.0, 0.15, 2.8}, random);
  const double partition_yaw = random.uniform(-0.6, 0.6);
  add_box(world, {partition_at, partition, partition_yaw}, random_reflectivity(random));

  const Vector3d table_at = somewhere_in(cells_x[1]);
  const Vector3d table = random_size({1.2, 0.7, 0.7}, {1.8, 1.0, 0.8}, random);
  const double table_yaw = random.uniform(-0.6, 0.6);
  add_box(world, {table_at, table, table_yaw}, random_reflectivity(random));
  const Vector3d on_table = table_at + Vector3d(0.0, 0.0, table.z());
  const Vector3d thing = random_size({0.3, 0.2, 0.3}, {0.6, 0.4, 0.6}, random);
  add_box(world, {on_table, thing, table_yaw}, random_reflectivity(random));

  const Vector3d ramp_at = somewhere_in(cells_x[2]);
  add_ramp(world, ramp_at, random);
}

/// A row of buildings on one side of the street, gaps between them, from one end to the other.
void add_buildings(std::vector<Rectangle>& world, double side, double half_street_m, const Eigen::Vector2d& slope,
                   Random& random) {
  for (double x = -half_street_m; x < half_street_m;) {
    const Vector3d size = random_size({10.0, 8.0, 5.0}, {18.0, 12.0, 15.0}, random);
    const double front_y = random.uniform(8.0, 11.0);
    const Eigen::Vector2d center(x + 0.5 * size.x(), side * (front_y + 0.5 * size.y()));
    // One metre below the ground, so that no wall floats over the slope.
    const Vector3d base(center.x(), center.y(), slope.dot(center) - 1.0);
    add_box(world, {base, size + Vector3d::UnitZ()}, random_reflectivity(random));
    x += size.x() + random.uniform(1.0, 5.0);
  }
}

}  // namespace

Scene room(std::uint64_t seed) {
  Random random(seed, 10);
  const Vector3d half_m = random_size({8.7, 5.7, 1.9}, {9.3, 6.3, 2.1}, random);
  std::vector<Rectangle> world;
  add_shell(world, half_m, random);
  add_furniture_along_walls(world, half_m, random);
  add_middle(world, random);
  const Lane lane{.straight_x_m = 6.8, .straight_y_m = 2.2, .corner_radius_m = 2.0};  // 10.8 x 6.2 m
  return {PlanesWorld(std::move(world)), lane};
}

Scene corridor(double length_m) {
  constexpr double kBeyondSight_m = 400.0;
  constexpr double kHalf_m = 1.5;
  const double half_length_m = 0.5 * length_m + kBeyondSight_m;
  const Vector3d center(0.5 * length_m, 0.0, kHalf_m);
  const Vector3d x(half_length_m, 0.0, 0.0), y(0.0, kHalf_m, 0.0), z(0.0, 0.0, kHalf_m);
  std::vector<Rectangle> world;
  for (const double side : {-1.0, 1.0}) {
    world.push_back({center + side * y, x, z, 0.6});
    world.push_back({center + side * z, x, y, 0.4});
  }
  return {PlanesWorld(std::move(world)), Lane{.straight_x_m = std::numeric_limits<double>::infinity()}};
}

Scene outdoor(std::uint64_t seed) {
  constexpr double kHalfStreet_m = 100.0;
  Random random(seed, 11);
  const double slope_x = random.uniform(-0.03, 0.03);
  const Eigen::Vector2d slope(slope_x, random.uniform(-0.02, 0.02));
  std::vector<Rectangle> world;
  const Vector3d along = Vector3d(1.0, 0.0, slope.x()).normalized();
  const Vector3d across = Vector3d(-slope.x(), -slope.y(), 1.0).normalized().cross(along);
  world.push_back({Vector3d::Zero(), 300.0 * along, 300.0 * across, 0.3});
  for (const double side : {-1.0, 1.0}) {
    add_buildings(world, side, kHalfStreet_m, slope, random);
    const Vector3d end = random_size({8.0, 14.0, 6.0}, {12.0, 20.0, 12.0}, random);
    const double end_x = side * (kHalfStreet_m + 0.5 * end.x());
    add_box(world, {{end_x, 0.0, slope.x() * end_x - 1.0}, end + Vector3d::UnitZ()}, random_reflectivity(random));
    for (double x = -85.0; x < 85.0; x += random.uniform(18.0, 40.0)) {
      const Vector3d vehicle = random_size({3.8, 1.7, 1.4}, {5.5, 2.0, 2.4}, random);
      const Eigen::Vector2d parked(x, side * 6.0);
      add_box(world, {{x, parked.y(), slope.dot(parked)}, vehicle}, random_reflectivity(random));
    }
  }
  return {PlanesWorld(std::move(world)),
          Lane{.straight_x_m = 160.0, .straight_y_m = 0.0, .corner_radius_m = 2.5, .height_m = 1.5, .slope = slope}};
}

}  // namespace pllit
