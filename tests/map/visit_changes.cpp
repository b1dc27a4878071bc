#include "pllit/map/visit_changes.hpp"

#include <gtest/gtest.h>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

/// What the later visit finds different about a wall.
struct Difference {
  double gain = 1.0, bias = 0.0;  ///< of all
  double patch = 0.0;             ///< of a third of a metre in the middle
  bool box = false;               ///< a hot thing in front of the wall
};

PointTable no_points() {
  return {.points = {}, .fields = {{"intensity", {}}, {"normal", {}}, {"sigma", {}}, {"images", {}}}};
}

/// A point that was seen often enough, as intense as is normal there.
void add_point(PointTable& table, const Vector3f& p_W, double value) {
  table.points.push_back(p_W);
  table.fields[0].values.push_back(static_cast<float>(value));
  table.fields[1].values.push_back(static_cast<float>(value));
  table.fields[2].values.push_back(5.0F);
  table.fields[3].values.push_back(20.0F);
}

/// Three metres by two of a wall with warm and cool bricks, as a thermographic map.
PointTable wall(Random& random, const Difference& difference = {}) {
  PointTable table = no_points();
  const auto add = [&](const Vector3f& p_W, double value) { add_point(table, p_W, value); };
  for (int i = 0; i < 60; ++i)
    for (int k = 0; k < 40; ++k) {
      const Vector3f p(0.05F * static_cast<float>(i) + 0.02F, 4.02F, 0.05F * static_cast<float>(k) + 0.02F);
      double value = 100.0 + 40.0 * ((i / 8 + k / 8) % 2) + random.normal(2.0);
      if (std::abs(i - 30) < 4 && std::abs(k - 20) < 4) value += difference.patch;
      add(p, difference.gain * value + difference.bias);
    }
  if (difference.box)
    for (int i = 0; i < 6; ++i)
      for (int k = 0; k < 6; ++k)
        add({0.8F + 0.05F * static_cast<float>(i), 3.52F, 0.8F + 0.05F * static_cast<float>(k)},
            difference.gain * 280.0 + difference.bias);
  return table;
}

void append(PointTable& table, const PointTable& more) {
  if (table.fields.empty()) table.fields.resize(more.fields.size());
  table.points.insert(table.points.end(), more.points.begin(), more.points.end());
  for (std::size_t i = 0; i < more.fields.size(); ++i) {
    table.fields[i].name = more.fields[i].name;
    table.fields[i].values.insert(table.fields[i].values.end(), more.fields[i].values.begin(),
                                  more.fields[i].values.end());
  }
}

/// The same room several times, six metres apart.
PointTable repeated(const PointTable& room, int times) {
  PointTable rooms;
  for (int i = 0; i < times; ++i) {
    PointTable next = room;
    for (Vector3f& p_W : next.points) p_W.y() += 6.0F * static_cast<float>(i);
    append(rooms, next);
  }
  return rooms;
}

const Vector3f kBeforeTheWall(1.5F, 1.0F, 1.0F), kBehindTheWall(1.5F, 7.0F, 1.0F);

/// With a LiDAR that measured it all from one place.
VisitHeat seen_from(const Vector3f& lidar_W, const PointTable& table) {
  VisitHeat visit{.heat = table};
  for (const Vector3f& p_W : table.points) visit.sightlines_W.push_back({lidar_W, p_W});
  return visit;
}

VisitChanges between(const PointTable& before, const PointTable& now) {
  return changes_between(seen_from(kBeforeTheWall, before), seen_from(kBeforeTheWall, now));
}

VisitChanges between(const Difference& difference) {
  Random random(1);
  const PointTable before = wall(random);
  return between(before, wall(random, difference));
}

TEST(VisitChanges, AreNoneWhereOnlyTheWeatherChanged) {
  const VisitChanges found = between({.gain = 1.3, .bias = -25.0});
  EXPECT_NEAR(found.drift.covered(), 1.0, 1e-9);
  EXPECT_GT(found.shared, 300);
  EXPECT_EQ(found.only_before + found.only_now, 0);
  EXPECT_TRUE(found.same_site);
  EXPECT_TRUE(found.changes.empty());
}

TEST(VisitChanges, TellWhatBecameHotterAndCoolerWhateverTheWeather) {
  for (const double patch : {80.0, -80.0}) {
    const VisitChanges found = between({.gain = 0.8, .bias = 30.0, .patch = patch});
    ASSERT_EQ(found.changes.size(), 1u);
    const VisitChange& change = found.changes.front();
    EXPECT_EQ(change.kind, patch > 0.0 ? VisitChangeKind::hotter : VisitChangeKind::cooler);
    EXPECT_NEAR(change.mean, patch, 20.0);  // voxels on its rim hold both
    EXPECT_LT((change.position_W - Vector3d(1.52, 4.02, 1.02)).norm(), 0.06);
  }
}

TEST(VisitChanges, AreSeenWhereTheScaleWandersFromRoomToRoom) {
  for (const double patch : {0.0, 80.0}) {
    Random random(3);
    const PointTable before = repeated(wall(random), 3);
    PointTable now;
    for (const double room : {0.0, 1.0, 2.0}) {
      const double change = room == 1.0 ? patch : 0.0;
      PointTable walls = wall(random, {.gain = 1.0 + 0.15 * room, .bias = 35.0 * room, .patch = change});
      for (Vector3f& p_W : walls.points) p_W.y() += 6.0F * static_cast<float>(room);
      append(now, walls);
    }
    const VisitChanges found = between(before, now);
    ASSERT_EQ(found.changes.size(), patch > 0.0 ? 1u : 0u);
    for (const VisitChange& change : found.changes)
      EXPECT_LT((change.position_W - Vector3d(1.52, 10.02, 1.02)).norm(), 0.1) << "to a voxel";
  }
}

TEST(VisitChanges, OfALinearCameraTellAThingThatFillsItsNeighbourhoodByTheRestOfTheSite) {
  Random random(5);
  const PointTable before = repeated(wall(random), 3);
  PointTable now = before;
  const auto in_cabinet = [](const Vector3f& p_W) { return p_W.y() > 8.0F && p_W.y() < 12.0F && p_W.x() > 0.4F; };
  for (std::size_t i = 0; i < now.points.size(); ++i)
    for (std::size_t field : {0U, 1U}) now.fields[field].values[i] += in_cabinet(now.points[i]) ? 80.0F : 0.0F;
  VisitChangesConfig config;
  config.drift.curve.shape = AnchorConfig::Shape::affine;
  config.drift.most_shift = 60.0;
  const VisitChanges found = changes_between(seen_from(kBeforeTheWall, before), seen_from(kBeforeTheWall, now), config);
  int voxels = 0;  // in pieces: at the bricks' seams a neighbour may explain a voxel
  for (const VisitChange& change : found.changes) {
    EXPECT_EQ(change.kind, VisitChangeKind::hotter);
    EXPECT_NEAR(change.mean, 80.0, 15.0);
    EXPECT_TRUE(in_cabinet(change.position_W.cast<float>()));
    voxels += change.voxels;
  }
  EXPECT_GT(voxels, 300);
}

TEST(VisitChanges, TellAHotThingThatWasNotThere) {
  const VisitChanges found = between({.box = true});
  ASSERT_EQ(found.changes.size(), 1u);
  EXPECT_EQ(found.changes.front().kind, VisitChangeKind::new_hot);
  EXPECT_LT((found.changes.front().position_W - Vector3d(0.92, 3.52, 0.92)).norm(), 0.06);
}

/// Points every 5 cm of a block, all of one intensity.
PointTable block(const Vector3f& from_W, const Eigen::Vector3i& points, double value) {
  PointTable table = no_points();
  for (int i = 0; i < points.x(); ++i)
    for (int j = 0; j < points.y(); ++j)
      for (int k = 0; k < points.z(); ++k)
        add_point(table, from_W + 0.05F * Eigen::Vector3i(i, j, k).cast<float>(), value);
  return table;
}

TEST(VisitChanges, TellAllOfAHotThingThatCameBesideOneThatWasAlwaysHot) {
  Random random(1);
  PointTable before = wall(random);
  append(before, block({1.22F, 3.02F, 0.32F}, {10, 11, 30}, 300.0));  // a machine, on both visits
  PointTable now = before;
  append(now, block({0.32F, 3.52F, 0.82F}, {16, 1, 10}, 280.0));
  const VisitChanges found = between(before, now);
  ASSERT_EQ(found.changes.size(), 1u);
  EXPECT_EQ(found.changes.front().kind, VisitChangeKind::new_hot);
  EXPECT_EQ(found.changes.front().voxels, 8 * 5);
  EXPECT_LT((found.changes.front().position_W - Vector3d(0.695, 3.52, 1.045)).norm(), 0.02);
}

TEST(VisitChanges, AreNotClaimedOfAPlaceThatTheFirstVisitDidNotLookThrough) {
  Random random(1);
  const PointTable before = wall(random), now = wall(random, {.box = true});
  EXPECT_TRUE(changes_between(seen_from(kBehindTheWall, before), seen_from(kBeforeTheWall, now)).changes.empty());
}

TEST(VisitChanges, TellWhatIsGone) {
  Random random(1);
  const PointTable before = wall(random, {.box = true}), now = wall(random);
  const VisitChanges found = between(before, now);
  ASSERT_EQ(found.changes.size(), 1u);
  EXPECT_EQ(found.changes.front().kind, VisitChangeKind::gone);
  EXPECT_LT((found.changes.front().position_W - Vector3d(0.92, 3.52, 0.92)).norm(), 0.06);
  EXPECT_TRUE(changes_between(seen_from(kBeforeTheWall, before), seen_from(kBehindTheWall, now)).changes.empty())
      << "what hides may still be there";
}

TEST(VisitChanges, AreNotMissedForBeingBrighterThanTheCameraShows) {
  Random random(4);
  const PointTable before = wall(random);
  PointTable now = wall(random, {.patch = 70.0});
  auto &sigma = now.fields[2].values, saturated = std::vector<float>(sigma.size(), 0.0F);
  for (std::size_t i = 0; i < sigma.size(); ++i)
    if (now.fields[0].values[i] > 165.0F) {
      saturated[i] = 1.0F;
      sigma[i] = 60.2F;
    }
  EXPECT_TRUE(between(before, now).changes.empty());
  now.fields.push_back({"saturated", saturated});
  EXPECT_EQ(between(before, now).changes.size(), 1u);
}

TEST(VisitChanges, SayNothingWhereTheVisitsShareTooLittle) {
  Random random(2);
  PointTable before = wall(random), elsewhere = wall(random);
  for (Vector3f& p : elsewhere.points) p.x() += 50.0F;
  const VisitChanges found = between(before, elsewhere);
  EXPECT_EQ(found.drift.covered(), 0.0);
  EXPECT_EQ(found.shared, 0);
  EXPECT_FALSE(found.same_site);
  EXPECT_TRUE(found.changes.empty());
  EXPECT_EQ(changes_between({}, {}).drift.covered(), 0.0);
}

}  // namespace
}  // namespace pllit
