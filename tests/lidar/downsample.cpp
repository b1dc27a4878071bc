#include "pllit/lidar/downsample.hpp"

#include <gtest/gtest.h>

#include <set>

#include "support/random_states.hpp"

namespace pllit {
namespace {

PointCloud random_cloud(unsigned seed, int count) {
  test::Random random(seed);
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    cloud.points_I.push_back(random.vector(3.0).cast<float>());
    cloud.intensity.push_back(static_cast<float>(i));
  }
  return cloud;
}

TEST(Downsample, KeepsPointsApartAndLeavesNoGapThatAPointCouldFill) {
  test::Random random(3);
  PointCloud cloud;
  for (int i = 0; i < 4000; ++i) {  // a wavy surface, so that no voxel is full
    const double x = random.uniform(-5.0, 5.0), y = random.uniform(-5.0, 5.0);
    cloud.points_I.push_back(Vector3d(x, y, std::sin(x) + random.normal(0.01)).cast<float>());
    cloud.intensity.push_back(static_cast<float>(i));
  }
  const std::vector<Vector3f> kept = downsample(cloud, 0.5).points_I;
  for (std::size_t i = 0; i < kept.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE((kept[i] - kept[j]).norm(), 0.5F);
  for (const Vector3f& p : cloud.points_I)
    EXPECT_TRUE(std::ranges::any_of(kept, [&](const Vector3f& q) { return (p - q).norm() < 0.5F; }));
}

TEST(Downsample, DoesNotTurnWallsInTheScannersSense) {
  // A square room seen by one ring, in the order of the azimuth: the torque of what the noise does to the kept points,
  // against its sigma.
  constexpr double half_m = 3.0, range_sigma_m = 0.01;
  double sum = 0.0, squares = 0.0;
  test::Random random(5);
  for (int scan = 0; scan < 2000; ++scan) {
    PointCloud cloud;
    for (int i = 0; i < 1000; ++i) {
      const double azimuth = 2.0 * M_PI * i / 1000.0;
      const Vector3d ray(std::cos(azimuth), std::sin(azimuth), 0.0);
      const double range_m = half_m / ray.cwiseAbs().maxCoeff() + random.normal(range_sigma_m);
      cloud.points_I.push_back((range_m * ray).cast<float>());
      cloud.intensity.push_back(0.0F);
    }
    double torque = 0.0;
    for (const Vector3f& p : downsample(cloud, 0.4).points_I) {
      const bool x_wall = std::abs(p.x()) > std::abs(p.y());
      const double across_m = x_wall ? p.x() : p.y(), along_m = x_wall ? -p.y() : p.x();
      torque += (std::abs(across_m) - half_m) * std::copysign(1.0, across_m) * along_m;
    }
    sum += torque;
    squares += torque * torque;
  }
  EXPECT_LT(std::abs(sum), 4.0 * std::sqrt(squares));
}

TEST(Downsample, DoesNotMoveAWallThatLiesNearAVoxelBorder) {
  test::Random random(4);
  for (const double height_m : {0.0, 0.003, 0.006, 0.01}) {
    PointCloud cloud;
    for (int i = 0; i < 200000; ++i) {
      cloud.points_I.push_back(
          Vector3d(random.uniform(-10.0, 10.0), random.uniform(-10.0, 10.0), height_m + random.normal(0.01))
              .cast<float>());
      cloud.intensity.push_back(0.0F);
    }
    const PointCloud kept = downsample(cloud, 0.2);
    double mean_m = 0.0;
    for (const Vector3f& p : kept.points_I) mean_m += p.z() / static_cast<double>(kept.points_I.size());
    EXPECT_NEAR(mean_m, height_m, 4.0 * 0.01 / std::sqrt(static_cast<double>(kept.points_I.size())));
  }
}

TEST(Downsample, MovesCloserWhereTooFewPointsRemain) {
  const PointCloud room = random_cloud(3, 5000);  // spread over what is too small for many points a metre apart
  const std::size_t few = downsample(room, 4.0).points_I.size();
  const std::size_t more = downsample(room, 4.0, 2 * few).points_I.size();
  EXPECT_GE(more, 2 * few);
  EXPECT_LT(more, 20 * few);
  EXPECT_EQ(downsample(room, 4.0, few / 2).points_I.size(), few);
  EXPECT_EQ(downsample(random_cloud(3, 5), 0.1, 100).points_I.size(), 5u);
}

TEST(Thin, KeepsAnEvenShareInOrder) {
  const PointCloud kept = thin(random_cloud(2, 1000), 250);
  ASSERT_EQ(kept.points_I.size(), 250u);
  for (std::size_t i = 0; i < 250; ++i) EXPECT_EQ(kept.intensity[i], static_cast<float>(4 * i));
  EXPECT_EQ(thin(random_cloud(2, 100), 250).points_I.size(), 100u);
}

TEST(FreshVoxels, TellsEachPlaceOnceAndForgetsWhatIsFarAway) {
  FreshVoxels fresh(0.5, 20.0);
  const std::vector<Vector3f> here{{0.1F, 0.1F, 0.1F}, {0.2F, 0.2F, 0.2F}, {1.1F, 0.0F, 0.0F}};
  EXPECT_THAT(fresh.select(here, Vector3d::Zero()), testing::ElementsAre(0u, 2u));
  EXPECT_THAT(fresh.select(here, Vector3d::Zero()), testing::IsEmpty());
  EXPECT_THAT(fresh.select({}, Vector3d(100.0, 0.0, 0.0)), testing::IsEmpty());
  EXPECT_THAT(fresh.select(here, Vector3d::Zero()), testing::ElementsAre(0u, 2u));
}

}  // namespace
}  // namespace pllit
