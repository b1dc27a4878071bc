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

TEST(Downsample, KeepsTheFirstPointOfEveryVoxel) {
  const PointCloud cloud = random_cloud(1, 5000);
  const PointCloud kept = downsample(cloud, 0.5);
  std::set<VoxelKey> expected;
  std::vector<float> first;
  for (std::size_t i = 0; i < cloud.points_I.size(); ++i)
    if (expected.insert(voxel_key(voxel_of(cloud.points_I[i], 2.0))).second) first.push_back(cloud.intensity[i]);
  EXPECT_EQ(kept.intensity, first);
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
