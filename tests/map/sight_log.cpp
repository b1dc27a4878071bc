#include "pllit/map/sight_log.hpp"

#include <gtest/gtest.h>

#include "support/box_before_wall.hpp"

namespace pllit {
namespace {

using test::Random;

std::vector<Vector3f> points(bool box) { return test::box_before_wall(box ? std::optional(0.2) : std::nullopt); }

Sight sight_at(Time time, const Vector3d& p_W, bool box) { return sight_of(time, p_W, points(box), {}); }

Time after(int seconds) { return Time{std::chrono::seconds(seconds)}; }

TEST(LookAt, TellsSurfacesFromFreeSpaceAndFromWhatIsHidden) {
  const Sight sight = sight_at(Time{}, Vector3d::Zero(), true);
  const auto kind = [&](const Vector3d& p_W) { return look_at(sight, p_W, {}); };
  EXPECT_EQ(kind({2.0, 0.0, 0.0}), PointSight::surface);
  EXPECT_EQ(kind({1.2, 0.0, 0.0}), PointSight::free);
  EXPECT_EQ(kind({4.0, 0.0, 0.0}), PointSight::hidden);
  EXPECT_EQ(kind({2.0, 1.0, 0.0}), PointSight::free);
  EXPECT_EQ(kind({4.0, 1.0, 0.0}), PointSight::surface);
  EXPECT_EQ(kind({-1.0, 0.0, 0.0}), PointSight::unknown);
  EXPECT_EQ(kind({4.0, 9.0, 0.0}), PointSight::unknown);
}

TEST(LookAt, SeesAllAroundAndAcrossTheSeam) {
  Random random(3);
  std::vector<Vector3f> sphere;
  for (int i = 0; i < 600000; ++i) sphere.push_back((5.0 * random.vector().normalized()).cast<float>());
  const Sight sight = sight_of(Time{}, Vector3d::Zero(), sphere, {});
  for (int i = 0; i < 500; ++i) {
    const Vector3d direction = random.vector().normalized();
    if (std::abs(direction.z()) > 0.8) continue;  // few points fall into the cells near the poles
    EXPECT_EQ(look_at(sight, 3.0 * direction, {}), PointSight::free) << direction.transpose();
    EXPECT_EQ(look_at(sight, 5.0 * direction, {}), PointSight::surface) << direction.transpose();
    EXPECT_EQ(look_at(sight, 7.0 * direction, {}), PointSight::hidden) << direction.transpose();
  }
  EXPECT_EQ(look_at(sight, {-3.0, 1e-9, 0.0}, {}), PointSight::free);
  EXPECT_EQ(look_at(sight, {-3.0, -1e-9, 0.0}, {}), PointSight::free);
}

TEST(SightLog, KnowsThatAPlaceWasFreeBeforeSomethingCame) {
  SightLog log({.spacing_m = 0.01});
  const Vector3d p_W(2.0, 0.0, 0.0);
  for (int i = 0; i < 10; ++i) log.add(sight_at(after(i), {0.0, 0.04 * i, 0.0}, i > 6));
  EXPECT_TRUE(log.evidence(p_W, after(6)).was_free());
  EXPECT_GE(log.evidence(p_W, after(6)).free, 4);
  EXPECT_EQ(log.evidence(p_W, after(6)).surface, 0);
  EXPECT_GE(log.evidence(p_W, after(60)).surface, 2);
  EXPECT_FALSE(log.evidence({4.0, 0.0, 0.0}, after(6)).was_free());
}

TEST(SightLog, KnowsThatSomethingCameHoweverLongItHasBeenThereSince) {
  SightLog log({.spacing_m = 0.01});
  const Vector3d p_W(2.0, 0.0, 0.0);
  for (int i = 0; i < 12; ++i) log.add(sight_at(after(i), {0.0, 0.01 * i, 0.0}, false));
  for (int i = 12; i < 60; ++i) log.add(sight_at(after(i), {0.0, 0.01 * (i % 12), 0.0}, true));
  const SightEvidence evidence = log.evidence(p_W, after(60));
  EXPECT_GT(evidence.surface, 3 * evidence.free);
  EXPECT_TRUE(evidence.was_free()) << evidence.free << " free";
}

TEST(SightLog, DoesNotTakeWhatIsSeenThroughFromAfarForFree) {
  SightLog log({.spacing_m = 0.01});
  const Vector3d p_W(2.0, 0.0, 0.0);
  for (int i = 0; i < 12; ++i) log.add(sight_at(after(i), {-1.0, 0.01 * i, 0.0}, false));  // from a metre farther
  for (int i = 12; i < 24; ++i) log.add(sight_at(after(i), {0.0, 0.01 * i, 0.0}, true));
  EXPECT_FALSE(log.evidence(p_W, after(60)).was_free());
}

TEST(SightLog, DoesNotTakeTheRimOfAThingForFree) {
  SightLog log({.spacing_m = 0.01});
  for (int i = 0; i < 12; ++i) log.add(sight_at(after(i), {0.0, -0.08, 0.0}, true));  // its rays come from the origin
  for (const double y_m : {0.17, 0.19, 0.195}) EXPECT_FALSE(log.evidence({2.0, y_m, 0.0}, after(60)).was_free()) << y_m;
}

TEST(SightLog, DoesNotTakeForFreeWhatRaysPassOnOneSideOnly) {
  std::vector<Vector3f> above = points(false);
  std::erase_if(above, [](const Vector3f& p_W) { return p_W.z() < 0.01F * p_W.x(); });
  SightLog log({.spacing_m = 0.01});
  for (int i = 0; i < 12; ++i) log.add(sight_of(after(i), Vector3d(0.0, 0.01 * i, 0.0), above, {}));
  EXPECT_EQ(log.evidence({2.0, 0.0, 0.01}, after(60)).free, 0);
  EXPECT_EQ(log.evidence({2.0, 0.0, 0.15}, after(60)).free, 12);
}

TEST(SightLog, KeepsSightsWhereTheRigMovesOrStandsAndForgetsTheOldest) {
  SightLog log({.spacing_m = 0.25, .spacing_s = 10.0, .most = 5});
  for (int i = 0; i < 8; ++i) log.add({.time = after(i), .p_W = {0.1 * i, 0.0, 0.0}});
  EXPECT_EQ(log.size(), 3u);  // at 0, 0.3 and 0.6 m
  log.add({.time = after(100), .p_W = {0.6, 0.0, 0.0}});
  EXPECT_EQ(log.size(), 4u);
  for (int i = 0; i < 8; ++i) log.add({.time = after(200 + i), .p_W = {1.0 * i, 0.0, 0.0}});
  EXPECT_EQ(log.size(), 5u);
}

}  // namespace
}  // namespace pllit
