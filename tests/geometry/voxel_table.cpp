#include "pllit/geometry/voxel_table.hpp"

#include <gtest/gtest.h>

#include <map>

#include "support/random_states.hpp"

namespace pllit {
namespace {

TEST(VoxelKey, IsInvertedByItsDecoder) {
  test::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3i voxel = Eigen::Vector3d(random.vector(1e5)).cast<int>();
    EXPECT_EQ(voxel_of_key(voxel_key(voxel)), voxel);
  }
}

TEST(VoxelOf, RoundsDownOnBothSidesOfTheOrigin) {
  EXPECT_EQ(voxel_of(Eigen::Vector3d(0.1, -0.1, -1.0), 1.0), Eigen::Vector3i(0, -1, -1));
}

TEST(VoxelTable, BehavesAsAStdMapOnRandomOperations) {
  test::Random random(2);
  VoxelTable<int> table;
  std::map<VoxelKey, int> twin;
  for (int i = 0; i < 20000; ++i) {
    const VoxelKey key = voxel_key(Eigen::Vector3d(random.vector(12.0)).cast<int>());
    const auto [cell, fresh] = table.insert(key);
    EXPECT_EQ(fresh, !twin.contains(key));
    *cell += i;
    twin[key] += i;
    if (i % 5000 == 4999) {
      const auto even = [](VoxelKey, int value) { return value % 2 == 0; };
      table.retain(even);
      std::erase_if(twin, [&](const auto& entry) { return !even(entry.first, entry.second); });
    }
  }
  for (int i = 0; i < 4000; ++i) {
    const VoxelKey key = voxel_key(Eigen::Vector3d(random.vector(12.0)).cast<int>());
    table.erase(key);
    twin.erase(key);
  }
  EXPECT_GT(twin.size(), 100u);
  EXPECT_EQ(table.size(), twin.size());
  for (const auto& [key, value] : twin) {
    ASSERT_NE(table.find(key), nullptr);
    EXPECT_EQ(*table.find(key), value);
  }
  EXPECT_EQ(table.find(voxel_key({9999, 0, 0})), nullptr);
}

}  // namespace
}  // namespace pllit
