#include "pllit/map/thermal_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

ThermalView view_of(Time time, const std::vector<Vector3d>& points_W, float intensity) {
  ThermalView view{.time = time};
  for (const Vector3d& p_W : points_W)
    view.observations.push_back({.p_W = p_W, .pixel_px = {0.0F, 0.0F}, .intensity = intensity, .raw = 7.0F});
  return view;
}

TEST(ThermalMap, CountsTheObservationsOfOneImageAsOneSample) {
  ThermalMap map({.voxel_m = 0.1});
  ThermalView view = view_of(Time{}, {{0.01, 0.02, 0.03}, {0.05, 0.06, 0.07}, {0.55, 0.0, 0.0}}, 100.0F);
  view.observations[1].intensity = 110.0F;
  const auto seen = map.integrate(view);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_TRUE(std::ranges::is_sorted(seen));
  const VoxelKey key = map.key_at({0.03, 0.03, 0.03});
  ASSERT_TRUE(map.find(key));
  EXPECT_EQ(map.find(key)->images, 1u);
  EXPECT_FLOAT_EQ(map.find(key)->mean, 105.0F);
  EXPECT_LT((map.position_W(key, *map.find(key)) - Vector3d(0.03, 0.04, 0.05)).norm(), 1e-6);
}

TEST(ThermalMap, IsTheSameWhateverTheOrderOfTheObservations) {
  Random random(1);
  std::vector<Vector3d> points_W;
  for (int i = 0; i < 500; ++i) points_W.push_back(random.vector(0.3));
  std::vector<Vector3d> reversed(points_W.rbegin(), points_W.rend());
  ThermalMap a({}), b({});
  for (int i = 0; i < 30; ++i) {
    const Time time{std::chrono::milliseconds(100 * i)};
    EXPECT_EQ(a.integrate(view_of(time, points_W, 100.0F)), b.integrate(view_of(time, reversed, 100.0F)));
  }
  ASSERT_EQ(a.size(), b.size());
  for (const Vector3d& p_W : points_W) {
    EXPECT_EQ(a.find(a.key_at(p_W))->mean, b.find(b.key_at(p_W))->mean);
    EXPECT_EQ(a.find(a.key_at(p_W))->points, b.find(b.key_at(p_W))->points);
  }
}

TEST(ThermalMap, KeepsWithinItsMemoryByDroppingWhatWasNotSeenForLongest) {
  ThermalMap map({.memory_mb = 2.0});
  std::size_t dropped = 0;
  for (int i = 0; i < 400; ++i) {  // a drive of 400 m along a wall
    std::vector<Vector3d> points_W;
    for (int k = 0; k < 200; ++k) points_W.emplace_back(i + 0.02 + 0.05 * (k % 20), 3.0, 0.02 + 0.05 * (k / 20));
    map.integrate(view_of(Time{std::chrono::milliseconds(100 * i)}, points_W, 100.0F));
    const PointTable table = map.trim();
    for (const ScalarField& field : table.fields) EXPECT_EQ(field.values.size(), table.points.size());
    for (const Eigen::Vector3f& p_W : table.points) EXPECT_LT(p_W.x(), static_cast<float>(i - 5));
    dropped += table.points.size();
    EXPECT_LT(map.bytes(), 2'000'000u);
  }
  EXPECT_EQ(dropped + map.size(), 400u * 200u);
  EXPECT_TRUE(map.find(map.key_at({399.02, 3.02, 0.02})));
}

TEST(ThermalMap, ForgetsASurfaceThatHasLeft) {
  ThermalMap map({});
  const Vector3d p_W(0.01, 0.01, 0.01);
  for (int i = 0; i < 30; ++i) map.integrate(view_of(Time{std::chrono::seconds(i)}, {p_W}, 90.0F));
  map.forget(p_W);
  map.forget({7.0, 7.0, 7.0});
  EXPECT_TRUE(map.table().points.empty());
  map.integrate(view_of(Time{std::chrono::seconds(40)}, {p_W}, 150.0F));
  EXPECT_EQ(map.find(map.key_at(p_W))->images, 1u);
  EXPECT_EQ(map.find(map.key_at(p_W))->mean, 150.0F);
  EXPECT_EQ(map.find(map.key_at(p_W))->first_seen, Time{std::chrono::seconds(40)});
}

TEST(ThermalMap, TellsEveryVoxelOnceInItsTable) {
  ThermalMap map({});
  map.integrate(view_of(Time{std::chrono::seconds(5)}, {{0.01, 0.01, 0.01}, {1.01, 0.01, 0.01}}, 90.0F));
  map.integrate(view_of(Time{std::chrono::seconds(7)}, {{0.01, 0.01, 0.01}}, 92.0F));
  const PointTable table = map.table();
  ASSERT_EQ(table.points.size(), 2u);
  ASSERT_EQ(table.fields.size(), ThermalMap::fields().size());
  std::multiset<float> normals(table.fields[1].values.begin(), table.fields[1].values.end());
  EXPECT_EQ(normals, (std::multiset<float>{90.0F, 91.0F}));
  std::multiset<float> seen_s(table.fields[7].values.begin(), table.fields[7].values.end());
  EXPECT_EQ(seen_s, (std::multiset<float>{0.0F, 2.0F}));
}

}  // namespace
}  // namespace pllit
