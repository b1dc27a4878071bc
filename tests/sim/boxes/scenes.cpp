#include "pllit/sim/boxes/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

double nearest_approach_m(const Scene& scene, const Motion& motion) {
  double nearest_m = 1e9;
  for (Time t = motion.start(); t <= motion.end(); t += std::chrono::milliseconds(20))
    nearest_m = std::min(nearest_m, scene.world.distance_m(motion.at(t).T_W_I.translation()));
  return nearest_m;
}

class EveryScene : public testing::TestWithParam<std::function<Scene(std::uint64_t)>> {};

TEST_P(EveryScene, LeavesRoomForEveryMotion) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = GetParam()(seed);
    EXPECT_GT(nearest_approach_m(scene, walk_along(scene.lane, {.seed = seed, .duration_s = 60.0})), 0.3) << seed;
    EXPECT_GT(nearest_approach_m(scene, walk_along(scene.lane, {.seed = seed, .duration_s = 60.0, .speed_mps = 3.0})),
              0.3)
        << seed;
    EXPECT_GT(nearest_approach_m(scene, fast_shake(scene.lane, {.seed = seed, .duration_s = 20.0})), 0.3) << seed;
  }
}

TEST_P(EveryScene, IsMadeOfTrueRectangles) {
  const Scene scene = GetParam()(3);
  for (const Rectangle& r : scene.world.rectangles()) {
    EXPECT_NEAR(r.half_u_W.normalized().dot(r.half_v_W.normalized()), 0.0, 1e-12);
    EXPECT_GT(r.reflectivity, 0.0);
    EXPECT_LE(r.reflectivity, 1.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene,
                         testing::Values([](std::uint64_t seed) { return room(seed); },
                                         [](std::uint64_t) { return corridor(100.0); },
                                         [](std::uint64_t seed) { return outdoor(seed); }));

TEST(Room, IsClosedOnAllSides) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Scene scene = room(seed);
    Random random(seed);
    for (int i = 0; i < 2000; ++i) {
      const auto hit = scene.world.cast({0.0, -3.1, 1.3}, random.gaussian3().normalized(), 120.0);
      ASSERT_TRUE(hit);
      EXPECT_LT(hit->range_m, 20.0);
    }
  }
}

TEST(Corridor, LooksTheSameFromEverywhereAlongIt) {
  const Scene scene = corridor(200.0);
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d direction = random.gaussian3().normalized();
    const auto here = scene.world.cast({0.0, 0.2, 1.3}, direction, 120.0);
    const auto there = scene.world.cast({200.0, 0.2, 1.3}, direction, 120.0);
    ASSERT_EQ(here.has_value(), there.has_value());
    if (here) {
      EXPECT_NEAR(here->range_m, there->range_m, 1e-9);
    }
  }
}

TEST(Corridor, HasNoEndWithinSight) {
  const Scene scene = corridor(200.0);
  for (const double x : {0.0, 200.0})
    for (const double side : {-1.0, 1.0})
      EXPECT_FALSE(scene.world.cast({x, 0.0, 1.3}, Eigen::Vector3d(side, 0.0, 0.001).normalized(), 120.0));
}

}  // namespace
}  // namespace pllit
