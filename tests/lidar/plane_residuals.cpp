#include "pllit/lidar/plane_residuals.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "pllit/lidar/degeneracy.hpp"
#include "pllit/state/iterated_update.hpp"
#include "support/random_states.hpp"

namespace pllit {
namespace {

namespace ix = error_index;
using test::Random;

/// Points on the inside of a box with half sides of 4, 3 and 2 m, in W.
std::vector<Vector3d> box_points(Random& random, int count) {
  std::vector<Vector3d> points;
  const Vector3d half(4.0, 3.0, 2.0);
  for (int i = 0; i < count; ++i) {
    Vector3d p(random.uniform(-half.x(), half.x()), random.uniform(-half.y(), half.y()),
               random.uniform(-half.z(), half.z()));
    p[i % 3] = (i / 3 % 2 ? 1.0 : -1.0) * half[i % 3];
    points.push_back(p);
  }
  return points;
}

struct Scene {
  PlaneMap map{{.voxel_m = 0.4}};
  PointCloud scan;  // as seen from `state`
  NavState state;
  Rig rig;
};

Scene box_scene(unsigned seed, double noise_m = 0.01) {
  Random random(seed);
  Scene scene;
  PointCloud map_points;
  for (const Vector3d& p : box_points(random, 60000))
    map_points.points_I.push_back((p + random.vector(noise_m)).cast<float>());
  map_points.intensity.assign(map_points.points_I.size(), 0.0F);
  scene.map.insert(map_points, SE3::Identity());
  scene.state = random.state();
  scene.state.p_W = random.vector(0.5);
  const SE3 T_I_W = scene.state.T_W_I().inverse();
  for (const Vector3d& p : box_points(random, 1500))
    scene.scan.points_I.push_back(T_I_W.act(p + random.vector(noise_m)).cast<float>());
  scene.scan.intensity.assign(scene.scan.points_I.size(), 0.0F);
  return scene;
}

TEST(PlaneResiduals, GradientMatchesCentralDifferencesOfTheCost) {
  const Scene scene = box_scene(51);
  Arena arena(1);
  const PlaneResidualConfig config{.max_information = 0.0};
  PlaneResiduals residuals(scene.scan, scene.map, scene.rig, Matrix6::Identity(), config, arena);
  const PlaneEquations at = residuals(scene.state);
  ASSERT_GT(at.sums.inliers, 1000);
  // The step is so small that no point finds another plane, which would be a leap of the cost.
  constexpr double kStep = 1e-8;
  for (int i = 0; i < 6; ++i) {
    Vector18 d = Vector18::Zero();
    d[i] = kStep;
    const double slope =
        (residuals(boxplus(scene.state, d)).sums.cost - residuals(boxplus(scene.state, -d)).sums.cost) / (2.0 * kStep);
    EXPECT_NEAR(slope, -2.0 * at.sums.b[i], 0.05 * at.sums.b.head<6>().norm() + 5.0) << "axis " << i;
  }
}

TEST(PlaneResiduals, BringABadPoseBackToTheTruth) {
  const Scene scene = box_scene(52);
  Random random(53);
  Arena arena(2);
  for (int i = 0; i < 10; ++i) {
    Vector18 offset = Vector18::Zero();
    offset.head<3>() = random.vector(0.03);
    offset.segment<3>(ix::p) = random.vector(0.1);
    Estimate prior{.mean = boxplus(scene.state, offset), .covariance = 1e-6 * Matrix18::Identity()};
    prior.covariance.topLeftCorner<6, 6>() = 0.04 * Matrix6::Identity();
    PlaneResiduals residuals(scene.scan, scene.map, scene.rig, prior.covariance.topLeftCorner<6, 6>(), {}, arena);
    const auto result =
        iterated_update(prior, [&](const NavState& x) { return residuals(x).sums; }, {.max_iterations = 15});
    const Vector18 error = boxminus(result.posterior.mean, scene.state);
    EXPECT_LT(error.head<3>().norm(), 0.002);
    EXPECT_LT(error.segment<3>(ix::p).norm(), 0.005);
  }
}

TEST(PlaneResiduals, AreTheSameToTheBitForAnyNumberOfThreads) {
  const Scene scene = box_scene(54);
  Arena one(1), four(4);
  PlaneResiduals a(scene.scan, scene.map, scene.rig, Matrix6::Identity(), {}, one);
  PlaneResiduals b(scene.scan, scene.map, scene.rig, Matrix6::Identity(), {}, four);
  const PlaneEquations ea = a(scene.state), eb = b(scene.state);
  EXPECT_EQ(ea.sums.H, eb.sums.H);
  EXPECT_EQ(ea.sums.b, eb.sums.b);
  EXPECT_EQ(ea.sums.cost, eb.sums.cost);
}

TEST(PlaneResiduals, DependOnTheStateAlone) {
  const Scene scene = box_scene(55);
  Arena arena(1);
  PlaneResiduals fresh(scene.scan, scene.map, scene.rig, Matrix6::Identity(), {}, arena);
  PlaneResiduals used(scene.scan, scene.map, scene.rig, Matrix6::Identity(), {}, arena);
  Random random(56);
  for (int i = 0; i < 5; ++i) used(boxplus(scene.state, Vector18::NullaryExpr([&] { return random.normal(0.1); })));
  EXPECT_EQ(used(scene.state).sums.H, fresh(scene.state).sums.H);
}

TEST(PlaneResiduals, ClaimNoMoreInformationThanTheCap) {
  const Scene scene = box_scene(57);
  Arena arena(1);
  const PlaneResidualConfig all{.max_information = 0.0}, capped{.max_information = 100.0};
  PlaneResiduals everything(scene.scan, scene.map, scene.rig, Matrix6::Identity(), all, arena);
  PlaneResiduals limited(scene.scan, scene.map, scene.rig, Matrix6::Identity(), capped, arena);
  const PlaneEquations full = everything(scene.state), part = limited(scene.state);
  EXPECT_EQ(full.sums.inliers, part.sums.inliers);
  EXPECT_NEAR(part.weight / full.weight, 100.0 / full.sums.inliers, 1e-12);
  EXPECT_LT((part.sums.H - full.sums.H * (100.0 / full.sums.inliers)).norm(), 1e-9 * full.sums.H.norm());
}

TEST(PlaneResiduals, LeaveOutPointsThatFitNoPlane) {
  Scene scene = box_scene(58);
  const auto inliers = [&] {
    Arena arena(1);
    return PlaneResiduals(scene.scan, scene.map, scene.rig, Matrix6::Zero(), {}, arena)(scene.state).sums.inliers;
  };
  const int before = inliers();
  const SE3 T_I_W = scene.state.T_W_I().inverse();
  for (int i = 0; i < 200; ++i) {  // a person in the room: far from the walls, and just in front of one
    scene.scan.points_I.push_back(T_I_W.act(Vector3d(0.001 * i, 0.5, 0.0)).cast<float>());
    scene.scan.points_I.push_back(T_I_W.act(Vector3d(3.7, 0.001 * i, 0.0)).cast<float>());
  }
  scene.scan.intensity.assign(scene.scan.points_I.size(), 0.0F);
  EXPECT_EQ(inliers(), before);
}

}  // namespace
}  // namespace pllit
