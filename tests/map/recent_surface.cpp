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

const ViewFrustum kAhead{.inward_W = {Vector3d::UnitZ(), Vector3d::UnitZ(), Vector3d::UnitZ(), Vector3d::UnitZ()}};
const Camera kCamera{.width = 640, .height = 512, .fx = 400.0, .fy = 400.0, .cx = 320.0, .cy = 256.0};
const ViewFrustum kAround{.inward_W = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()}};

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
  for (int scan = 0; scan < 20; ++scan) surface.add({}, Vector3d(0.0, 0.0, 20.0), at(4500));
  EXPECT_EQ(surface.size(), 0u);
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
  const auto places_W = surface.carve(sight_of(at(100), Vector3d::Zero(), wall_W, {}), {}, kAhead, {});
  EXPECT_GT(places_W.size(), before / 2);
  std::size_t left = 0, wall = 0;
  for (const Vector3f& p_W : surface.points(kAhead, towards_camera).points_W) ++(p_W.z() < 2.2F ? left : wall);
  EXPECT_LT(left, before / 10);
  EXPECT_GT(wall, 300u);
}

TEST(RecentSurface, LosesInTurnWhatIsSeenThroughInAViewAndOutsideIt) {
  Random random(7);
  const std::vector<Vector3f> near_W = square(random, 2.0, 2000);
  const std::vector<Vector3f> wall_W = [&] {
    std::vector<Vector3f> points_W = square(random, 2.5, 12000);
    for (Vector3f& p_W : points_W) p_W.head<2>() *= 2.0F;
    return points_W;
  }();
  const auto left_of = [&](const ViewFrustum& view, RecentSurface::Parts parts, int calls) {
    RecentSurface surface({});
    surface.add(near_W, Vector3d::Zero(), at(0));
    surface.add(wall_W, Vector3d::Zero(), at(100));
    for (int call = 0; call < calls; ++call)
      surface.carve(sight_of(at(100), Vector3d::Zero(), wall_W, {}), {}, view, parts);
    const auto points_W = surface.points(kAhead, towards_camera).points_W;
    return std::ranges::count_if(points_W, [](const Vector3f& p_W) { return p_W.z() < 2.2F; });
  };
  const ViewFrustum behind{
      .inward_W = {-Vector3d::UnitZ(), -Vector3d::UnitZ(), -Vector3d::UnitZ(), -Vector3d::UnitZ()}};
  const auto all = left_of(kAhead, {.view = 0, .rest = 1}, 3), none = left_of(kAhead, {.view = 1, .rest = 0}, 1);
  EXPECT_GT(all, 5 * none);
  EXPECT_EQ(left_of(behind, {.view = 1, .rest = 0}, 3), all);
  EXPECT_EQ(left_of(behind, {.view = 0, .rest = 3}, 3), none);
  EXPECT_EQ(left_of(kAhead, {.view = 2, .rest = 0}, 2), none);
  EXPECT_GT(left_of(kAhead, {.view = 2, .rest = 0}, 1), none);
}

TEST(RecentSurface, ShowsOfAViewAllThatLiesInIt) {
  Random random(5);
  RecentSurface surface({});
  std::vector<Vector3f> points_W;
  for (int i = 0; i < 20000; ++i)
    points_W.push_back((random.uniform(1.0, 9.0) * random.vector(1.0).normalized()).cast<float>());
  surface.add(points_W, Vector3d::Zero(), at(0));
  const std::vector<Vector3f> all_W = surface.points(kAround, towards_camera).points_W;
  EXPECT_EQ(all_W.size(), surface.size());
  for (const double reach_m : {4.0, 7.0, 20.0}) {
    const ViewFrustum view = view_frustum(pose_from(random.rotation(), random.vector(0.3)), kCamera, reach_m);
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

}  // namespace
}  // namespace pllit
