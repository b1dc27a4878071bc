#include "pllit/geometry/voxel_blocks.hpp"

#include <gtest/gtest.h>

#include <map>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using Twin = std::map<VoxelKey, int>;

VoxelKey random_key(test::Random& random) { return voxel_key(Eigen::Vector3d(random.vector(12.0)).cast<int>()); }

void expect_same(const VoxelBlocks<int>& blocks, const Twin& twin) {
  EXPECT_EQ(blocks.size(), twin.size());
  for (const auto& [key, value] : twin) {
    ASSERT_NE(blocks.find(key), nullptr);
    EXPECT_EQ(*blocks.find(key), value);
  }
  Twin visited;
  blocks.for_each([&](const Eigen::Vector3i& voxel, int value) { visited[voxel_key(voxel)] = value; });
  EXPECT_EQ(visited, twin);
}

TEST(VoxelBlocks, BehaveAsAStdMapOnRandomOperations) {
  test::Random random(2);
  VoxelBlocks<int> blocks;
  Twin twin;
  for (int i = 1; i <= 20000; ++i) {
    const VoxelKey key = random_key(random);
    const auto [cell, is_new] = blocks.insert(key);
    EXPECT_EQ(is_new, !twin.contains(key));
    *cell += i;
    twin[key] += i;
    if (i % 5000 != 0) continue;
    blocks.retain([](const Eigen::Vector3i& voxel, int value) { return value % 2 == 0 && voxel.x() != 3; });
    std::erase_if(twin, [](const auto& entry) { return entry.second % 2 != 0 || voxel_of_key(entry.first).x() == 3; });
    EXPECT_GT(twin.size(), 100u);
    expect_same(blocks, twin);
  }
  EXPECT_EQ(blocks.find(voxel_key({9999, 0, 0})), nullptr);
}

TEST(VoxelBlocks, AreThinnedByAndByAsAtOnce) {
  test::Random random(3);
  VoxelBlocks<int> blocks;
  Twin twin;
  for (int i = 0; i < 5000; ++i) {
    const VoxelKey key = random_key(random);
    *blocks.insert(key).first = twin[key] = i;
  }
  const std::size_t all = blocks.blocks().size();
  for (std::size_t seen = 0; seen < all; seen += 7)
    blocks.retain_in(7, [](const Eigen::Vector3i&, int value) { return value % 3 == 0; });
  std::erase_if(twin, [](const auto& entry) { return entry.second % 3 != 0; });
  expect_same(blocks, twin);
}

TEST(VoxelBlocks, UseTheMemoryOfWhatWasTakenOutAgain) {
  VoxelBlocks<int> blocks;
  std::size_t early = 0;
  for (int x = 0; x < 4000; ++x) {
    for (int y = 0; y < 20; ++y) *blocks.insert(voxel_key({x, y, 0})).first = x;
    blocks.retain([x](const Eigen::Vector3i& voxel, int) { return voxel.x() > x - 100; });
    if (x == 200) early = blocks.bytes();
  }
  EXPECT_EQ(blocks.size(), 100u * 20u);
  EXPECT_LE(blocks.bytes(), early);
}

}  // namespace
}  // namespace pllit
