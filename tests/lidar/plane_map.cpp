#include "pllit/lidar/plane_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

/// Points on the plane through `centre` with the given rotation
/// (its z axis is the normal), with noise along the normal.
PointCloud plane_points(Random& random, const Vector3d& centre, const SO3& rotation, double half_m, double noise_m,
                        int count) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const Vector3d p(random.uniform(-half_m, half_m), random.uniform(-half_m, half_m), random.normal(noise_m));
    cloud.points_I.push_back((rotation.act(p) + centre).cast<float>());
    cloud.intensity.push_back(0.0F);
  }
  return cloud;
}

TEST(PlaneMap, FindsThePlaneThatThePointsLieOn) {
  Random random(31);
  for (int i = 0; i < 50; ++i) {
    const Vector3d centre = random.vector(30.0);
    const SO3 rotation = random.rotation();
    PlaneMap map({.voxel_m = 0.5});
    map.insert(plane_points(random, centre, rotation, 2.0, 0.005, 4000), SE3::Identity());
    const auto plane = map.plane_at(centre);
    ASSERT_TRUE(plane);
    EXPECT_GT(std::abs(plane->normal_W().dot(rotation.act(Vector3d::UnitZ()))), 0.9995);
    EXPECT_LT(std::abs(plane->distance_m(centre)), 0.005);
    EXPECT_NEAR(std::sqrt(plane->variances_m2[0]), 0.005, 0.002);
  }
}

TEST(PlaneMap, EqualsAFitToAllPointsOfItsWindow) {
  Random random(32);
  PlaneMap map({.voxel_m = 0.5, .max_points = 100000});
  const PointCloud cloud = plane_points(random, Vector3d(3.1, -2.2, 0.7), random.rotation(), 3.0, 0.01, 6000);
  map.insert(cloud, SE3::Identity());
  const Vector3d query(3.1, -2.2, 0.7);
  // The obvious twin: the window is the 2 x 2 x 2 voxels around the corner that is nearest to the query.
  Eigen::Array3d low;
  for (int i = 0; i < 3; ++i) low[i] = 0.5 * std::floor(query[i] / 0.5 - 0.5);
  std::vector<Vector3d> inside;
  for (const Vector3f& p : cloud.points_I)
    if ((p.cast<double>().array() >= low).all() && (p.cast<double>().array() < low + 1.0).all())
      inside.push_back(p.cast<double>());
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : inside) mean += p / static_cast<double>(inside.size());
  Matrix3d covariance = Matrix3d::Zero();
  for (const Vector3d& p : inside)
    covariance += (p - mean) * (p - mean).transpose() / static_cast<double>(inside.size());
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(covariance);

  const auto plane = map.plane_at(query);
  ASSERT_TRUE(plane);
  EXPECT_EQ(plane->points, static_cast<double>(inside.size()));
  EXPECT_LT((plane->centroid_W - mean).norm(), 1e-5);
  EXPECT_GT(std::abs(plane->normal_W().dot(eigen.eigenvectors().col(0))), 1.0 - 1e-7);
  EXPECT_NEAR(plane->variances_m2[2], eigen.eigenvalues()[2], 1e-6);
}

TEST(PlaneMap, ClaimsTheHeightAndTiltErrorsThatItMakes) {
  Random random(33);
  double height = 0.0, tilt = 0.0;
  constexpr int runs = 400;
  for (int i = 0; i < runs; ++i) {
    PlaneMap map({.voxel_m = 1.0, .max_thickness = 0.5});
    const Vector3d centre = random.vector(5.0);
    const SO3 rotation = random.rotation();
    map.insert(plane_points(random, centre, rotation, 0.5, 0.02, 60), SE3::Identity());
    const auto plane = map.plane_at(centre);
    ASSERT_TRUE(plane);
    const Vector3d query = centre + rotation.act(Vector3d(0.3, -0.2, 0.0));
    height += std::pow(plane->distance_m(query), 2) / plane->height_variance_m2(query) / runs;
    Vector3d normal = rotation.act(Vector3d::UnitZ());
    if (normal.dot(plane->normal_W()) < 0.0) normal = -normal;
    const Vector3d error = plane->axes_W.transpose() * (normal - plane->normal_W());
    const Matrix3d P = plane->axes_W.transpose() * plane->normal_covariance() * plane->axes_W;
    tilt += (error[1] * error[1] / P(1, 1) + error[2] * error[2] / P(2, 2)) / 2.0 / runs;
  }
  EXPECT_NEAR(height, 1.0, 0.25);
  EXPECT_NEAR(tilt, 1.0, 0.25);
}

TEST(PlaneMap, SeesNoPlaneInACloudOrALineOrTooFewPoints) {
  Random random(34);
  PlaneMap map({.voxel_m = 0.5});
  PointCloud ball, line;
  for (int i = 0; i < 500; ++i) {
    ball.points_I.push_back((Vector3d(10.0, 0.0, 0.0) + random.vector(0.3)).cast<float>());
    line.points_I.push_back((Vector3d(20.0, random.uniform(-1.0, 1.0), 0.0) + random.vector(0.01)).cast<float>());
  }
  map.insert(ball, SE3::Identity());
  map.insert(line, SE3::Identity());
  map.insert(plane_points(random, Vector3d(30.0, 0.0, 0.0), SO3::Identity(), 0.2, 0.001, 5), SE3::Identity());
  EXPECT_FALSE(map.plane_at({10.0, 0.0, 0.0}));
  EXPECT_FALSE(map.plane_at({20.0, 0.0, 0.0}));
  EXPECT_FALSE(map.plane_at({30.0, 0.0, 0.0}));
  EXPECT_FALSE(map.plane_at({40.0, 0.0, 0.0}));
  // Points that make no plane are known all the same.
  EXPECT_TRUE(map.knows({10.0, 0.0, 0.0}));
  EXPECT_TRUE(map.knows({20.0, 0.0, 0.0}));
  EXPECT_FALSE(map.knows({30.0, 0.0, 0.0}));
  EXPECT_FALSE(map.knows({40.0, 0.0, 0.0}));
}

TEST(PlaneMap, DropsWhatIsFarAndKeepsWhatIsNear) {
  Random random(35);
  PlaneMap map({.voxel_m = 0.5, .radius_m = 20.0});
  map.insert(plane_points(random, Vector3d::Zero(), SO3::Identity(), 1.0, 0.01, 500), SE3::Identity());
  map.insert(plane_points(random, Vector3d(30.0, 0.0, 0.0), SO3::Identity(), 1.0, 0.01, 500), SE3::Identity());
  map.slide(Vector3d(30.0, 0.0, 0.0));
  EXPECT_FALSE(map.plane_at(Vector3d::Zero()));
  EXPECT_TRUE(map.plane_at({30.0, 0.0, 0.0}));
}

TEST(PlaneMap, StaysWithinItsMemoryHoweverFarTheRobotGoes) {
  Random random(36);
  PlaneMap map({.voxel_m = 0.2, .radius_m = 1000.0, .memory_mb = 16.0});
  for (int i = 0; i < 60; ++i) {
    const Vector3d centre(10.0 * i, 0.0, 0.0);
    map.insert(plane_points(random, centre, SO3::Identity(), 10.0, 0.01, 20000), SE3::Identity());
    map.slide(centre);
    EXPECT_LE(static_cast<double>(map.bytes()), 16e6);
    EXPECT_TRUE(map.plane_at(centre));
  }
}

}  // namespace
}  // namespace pllit
