#include "pllit/sim/boxes/planes_world.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <optional>
#include <vector>

#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

using Eigen::Vector3d;

std::vector<Rectangle> random_rectangles(int count, Random& random) {
  std::vector<Rectangle> rectangles;
  for (int i = 0; i < count; ++i) {
    const Vector3d center = 6.0 * random.gaussian3(), u = random.gaussian3();
    const Vector3d v = u.cross(random.gaussian3()).normalized() * random.uniform(0.3, 3.0);
    rectangles.push_back({center, u, v, 0.5});
  }
  return rectangles;
}

/// The obvious twin: solves origin + range * direction = center + a * u + b * v for each rectangle.
std::optional<RayHit> cast_by_solving(const PlanesWorld& world, const Vector3d& origin, const Vector3d& direction,
                                      double max_range_m) {
  std::optional<RayHit> nearest;
  for (std::size_t i = 0; i < world.rectangles().size(); ++i) {
    const Rectangle& r = world.rectangles()[i];
    Eigen::Matrix3d A;
    A << direction, -r.half_u_W, -r.half_v_W;
    const Vector3d x = A.fullPivLu().solve(r.center_W - origin);
    if (x[0] <= 0.0 || x[0] >= max_range_m || std::abs(x[1]) > 1.0 || std::abs(x[2]) > 1.0) continue;
    if (!nearest || x[0] < nearest->range_m)
      nearest = {x[0], i, std::abs(r.half_u_W.cross(r.half_v_W).normalized().dot(direction))};
  }
  return nearest;
}

TEST(PlanesWorld, CastsRaysAsSolvingEachRectangleDoes) {
  Random random(1);
  const PlanesWorld world(random_rectangles(40, random));
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d origin = 3.0 * random.gaussian3(), direction = random.gaussian3().normalized();
    const auto expected = cast_by_solving(world, origin, direction, 9.0);
    const auto hit = world.cast(origin, direction, 9.0);
    ASSERT_EQ(hit.has_value(), expected.has_value());
    if (!hit) continue;
    ++hits;
    EXPECT_EQ(hit->rectangle, expected->rectangle);
    EXPECT_NEAR(hit->range_m, expected->range_m, 1e-9);
    EXPECT_NEAR(hit->cos_incidence, expected->cos_incidence, 1e-12);
  }
  EXPECT_GT(hits, 3000);
  EXPECT_LT(hits, 19000);
}

TEST(PlanesWorld, FindsForAFanOfRaysWhatItFindsAmongAllRectangles) {
  Random random(2);
  const PlanesWorld world(random_rectangles(60, random));
  std::size_t looked_at = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d origin = 3.0 * random.gaussian3(), normal = random.gaussian3().normalized();
    const auto fan = world.near_plane(origin, normal, 0.01);
    looked_at += fan.size();
    for (int ray = 0; ray < 10; ++ray) {
      const Vector3d in_plane = normal.cross(random.gaussian3()).normalized();
      const Vector3d direction = (in_plane + random.uniform(-0.01, 0.01) * normal).normalized();
      const auto among_all = world.cast(origin, direction, 50.0), in_fan = world.cast(origin, direction, 50.0, fan);
      ASSERT_EQ(among_all.has_value(), in_fan.has_value());
      if (in_fan) {
        EXPECT_EQ(among_all->rectangle, in_fan->rectangle);
      }
    }
  }
  EXPECT_LT(looked_at, 2000u * 60u / 2u);
}

TEST(PlanesWorld, MeasuresTheDistanceToFacesEdgesAndCorners) {
  const PlanesWorld world({{Vector3d(0, 0, 1), Vector3d(2, 0, 0), Vector3d(0, 1, 0), 0.5}});
  EXPECT_DOUBLE_EQ(world.distance_m({1.0, -0.5, 4.0}), 3.0);
  EXPECT_DOUBLE_EQ(world.distance_m({5.0, 0.5, 1.0}), 3.0);
  EXPECT_DOUBLE_EQ(world.distance_m({5.0, 5.0, 1.0}), 5.0);
  EXPECT_DOUBLE_EQ(world.distance_m({0.0, 0.0, 1.0}), 0.0);
}

TEST(PlanesWorld, SeesNothingBehindBeyondOrBesideASurface) {
  const PlanesWorld world({{Vector3d(5, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1), 0.5}});
  const Vector3d origin = Vector3d::Zero();
  EXPECT_TRUE(world.cast(origin, Vector3d::UnitX(), 5.1));
  EXPECT_FALSE(world.cast(origin, Vector3d::UnitX(), 4.9));
  EXPECT_FALSE(world.cast(origin, -Vector3d::UnitX(), 100.0));
  EXPECT_FALSE(world.cast(origin, Vector3d(5.0, 1.1, 0.0).normalized(), 100.0));
  EXPECT_FALSE(world.cast({5.0, -3.0, 0.0}, Vector3d::UnitY(), 100.0)) << "a ray inside the plane sees its edge only";
}

}  // namespace
}  // namespace pllit
