#include "pllit/map/recent_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

Time at(int ms) { return Time{std::chrono::milliseconds(ms)}; }

/// The points of a square metre at z = depth.
std::vector<Vector3f> square(Random& random, double depth, int count) {
  std::vector<Vector3f> points_W;
  for (int i = 0; i < count; ++i)
    points_W.emplace_back(static_cast<float>(random.uniform(-0.5, 0.5)), static_cast<float>(random.uniform(-0.5, 0.5)),
                          static_cast<float>(depth));
  return points_W;
}

const ViewCone kAhead{Vector3d::Zero(), Vector3d::UnitZ(), 0.0};

Vector3f towards_camera(const Vector3d&) { return -Vector3f::UnitZ(); }

TEST(RecentSurface, KeepsOnePointAVoxelWithItsNormal) {
  RecentSurface surface({});
  const std::vector<Vector3f> points_W{{0.01F, 0.01F, 2.01F}, {0.03F, 0.03F, 2.03F}, {0.21F, 0.01F, 2.01F}};
  surface.add(points_W, Vector3d::Zero(), at(0));
  const SurfacePoints points = surface.points(kAhead, towards_camera);
  ASSERT_EQ(points.points_W.size(), 2u);
  ASSERT_EQ(points.normals_W.size(), 2u);
  EXPECT_EQ(points.normals_W[0], Vector3f(-Vector3f::UnitZ()));
  const bool first = points.points_W[0].x() < 0.1F;
  EXPECT_LT((points.points_W[first ? 0 : 1] - Vector3f(0.02F, 0.02F, 2.02F)).norm(), 1e-5F);
}

TEST(RecentSurface, ForgetsWhatIsOldOrFar) {
  Random random(1);
  RecentSurface surface({.radius_m = 10.0, .memory_m = 100.0, .memory_s = 2.0});
  surface.add(square(random, 2.0, 500), Vector3d::Zero(), at(0));
  EXPECT_GT(surface.size(), 100u);
  surface.add(std::vector<Vector3f>{{0.0F, 0.0F, 30.0F}, {0.0F, 0.0F, 5.0F}}, Vector3d::Zero(), at(3000));
  ASSERT_EQ(surface.points(kAhead, towards_camera).points_W.size(), 1u);
  EXPECT_LT((surface.points(kAhead, towards_camera).points_W[0] - Vector3f(0.0F, 0.0F, 5.0F)).norm(), 1e-5F);
  surface.add({}, Vector3d(0.0, 0.0, 20.0), at(4500));
  EXPECT_TRUE(surface.points(kAhead, towards_camera).points_W.empty());
}

TEST(RecentSurface, ForgetsWhatWasSeenFromElsewhere) {
  Random random(4);
  RecentSurface surface({.memory_m = 0.5});
  surface.add(square(random, 2.0, 500), Vector3d::Zero(), at(0));
  surface.add({}, Vector3d(0.4, 0.0, 0.0), at(100));
  EXPECT_FALSE(surface.points(kAhead, towards_camera).points_W.empty());
  surface.add({}, Vector3d(0.2, 0.0, 0.0), at(200));  // there and back is way too
  EXPECT_TRUE(surface.points(kAhead, towards_camera).points_W.empty());
}

TEST(RecentSurface, LosesWhatTheLastScansSeeThrough) {
  Random random(2);
  RecentSurface surface({});
  surface.add(square(random, 2.0, 2000), Vector3d::Zero(), at(0));
  const std::size_t before = surface.points(kAhead, towards_camera).points_W.size();
  std::vector<Vector3f> wall_W = square(random, 2.5, 12000);
  for (Vector3f& p_W : wall_W) p_W.head<2>() *= 2.0F;
  surface.add(wall_W, Vector3d::Zero(), at(100));
  const auto places_W = surface.carve(sight_of(at(100), Vector3d::Zero(), wall_W, {}), {}, 1);
  EXPECT_GT(places_W.size(), before / 2);
  std::size_t left = 0, wall = 0;
  for (const Vector3f& p_W : surface.points(kAhead, towards_camera).points_W) ++(p_W.z() < 2.2F ? left : wall);
  EXPECT_LT(left, before / 10);
  EXPECT_GT(wall, 300u);
}

TEST(RecentSurface, ShowsOfAViewAllThatLiesInIt) {
  Random random(5);
  RecentSurface surface({});
  std::vector<Vector3f> points_W;
  for (int i = 0; i < 20000; ++i)
    points_W.push_back((random.uniform(1.0, 9.0) * random.vector(1.0).normalized()).cast<float>());
  surface.add(points_W, Vector3d::Zero(), at(0));
  const std::vector<Vector3f> all_W =
      surface.points({Vector3d::Zero(), Vector3d::UnitZ(), -1.0}, towards_camera).points_W;
  EXPECT_EQ(all_W.size(), surface.size());
  for (const double least_cos : {0.0, 0.5, 0.9}) {
    const ViewCone view{random.vector(0.3), random.vector(1.0).normalized(), least_cos, 7.0};
    const auto inside =
        std::ranges::count_if(all_W, [&](const Vector3f& p_W) { return view.contains(p_W.cast<double>()); });
    EXPECT_EQ(surface.points(view, towards_camera).points_W.size(), static_cast<std::size_t>(inside));
    EXPECT_GT(inside, 100);
  }
}

TEST(RecentSurface, HoldsNoMoreAfterALongWayThanAfterAShortOne) {
  Random random(6);
  RecentSurface surface({.memory_m = 0.5});
  std::size_t early = 0;
  for (int step = 0; step < 400; ++step) {
    const Vector3d centre_W(0.25 * step, 0.0, 0.0);
    std::vector<Vector3f> points_W = square(random, 2.0, 300);
    for (Vector3f& p_W : points_W) p_W += centre_W.cast<float>();
    surface.add(points_W, centre_W, at(100 * step));
    if (step == 100) early = surface.bytes();
  }
  EXPECT_LE(surface.bytes(), 2 * early);
}

TEST(ViewCone, HoldsAllThatTheImageShows) {
  Random random(3);
  const Camera camera{.width = 320, .height = 256, .fx = 300.0, .fy = 310.0, .cx = 150.0, .cy = 120.0, .k = {-0.2}};
  const SE3 T_W_C(Vector3d(1.0, 2.0, 3.0), exp_so3({0.3, -1.0, 2.0}));
  const ViewCone cone = view_cone(T_W_C, camera, 100.0);
  int in_cone = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p_C = random.vector(3.0);
    const auto pixel = camera.project(p_C);
    const bool shown = pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() <= 319.0 && pixel->y() <= 255.0;
    const bool contained = cone.contains(T_W_C.act(p_C));
    EXPECT_TRUE(contained || !shown) << p_C.transpose();
    in_cone += contained ? 1 : 0;
  }
  EXPECT_LT(in_cone, 2000 / 5);
}

}  // namespace
}  // namespace pllit
