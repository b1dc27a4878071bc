#include "pllit/sim/sightings.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/world/test_place.hpp"

namespace pllit {
namespace {

/// A side of a box, a point every 5 mm.
void add_side(Sighting& sighting, float x_m, float width_m, int times) {
  for (int round = 0; round < times; ++round)
    for (float y = 0.0025F; y < width_m; y += 0.005F)
      for (float z = 0.0025F; z < 0.2F; z += 0.005F) sighting.add({x_m, y, z}, 1.0);
}

TEST(Sighting, HasNoCentroidBeforeAnythingWasSeen) { EXPECT_FALSE(Sighting().centroid_O()); }

TEST(Sighting, CountsWhatWasSeenLongNoMoreThanWhatWasSeenOnce) {
  Sighting even, uneven;
  for (Sighting* sighting : {&even, &uneven}) add_side(*sighting, 0.0F, 0.2F, 1);
  add_side(even, 1.0F, 0.2F, 1);
  add_side(uneven, 1.0F, 0.2F, 50);
  EXPECT_LT((*even.centroid_O() - Vector3d(0.5, 0.1, 0.1)).norm(), 1e-3);
  EXPECT_LT((*uneven.centroid_O() - *even.centroid_O()).norm(), 1e-3);
}

TEST(Sighting, LiesOnTheSideThatWasSeen) {
  Sighting sighting;
  add_side(sighting, 0.3F, 0.4F, 2);
  EXPECT_LT((*sighting.centroid_O() - Vector3d(0.3, 0.2, 0.1)).norm(), 1e-3);
}

TEST(Sightings, CountNothingAsHotBeforeItHasWarmedUp) {
  Actor actor;
  actor.appears_s = 3.0;
  EXPECT_EQ(hot_from_s(actor), 3.0) << "brought in hot";
  const auto warmed_by = [](float by_K) {
    Actor warming;
    warming.heating = {{.at_s = 10.0, .by_K = by_K, .over_s = 15.0}};
    return by_K * (1.0 - std::exp((10.0 - hot_from_s(warming)) / 15.0));
  };
  EXPECT_NEAR(warmed_by(25.0F), 5.0, 1e-6);
  EXPECT_NEAR(warmed_by(5.0F), 4.0, 1e-6);
}

TEST(Sightings, CountThePartOfALongThingThatIsNearEnough) {
  // A strip on the ground from 8 to 14 m before the camera.
  testing::ReadyPlace place;
  place.surfaces_.resize(1);
  Actor strip{.name = "strip", .mesh_O = {}, .path = {{.at_s = 0.0, .T_W_O = SE3::Identity()}}, .heating = {}};
  strip.finding = true;
  testing::add_sheet(strip.mesh_O, {8.0, -0.5, 0.0}, 6.0 * Vector3d::UnitX(), Vector3d::UnitY(), 0);
  place.actors_.push_back(strip);
  RayCaster caster(place, 100.0);
  caster.move_to(Vector3d::Zero(), 1.0);
  const Camera camera{.width = 640, .height = 512, .fx = 500.0, .fy = 500.0, .cx = 319.5, .cy = 255.5};
  Matrix3d R_W_C;
  R_W_C << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  const auto seen_from = [&](double x_m) {
    Sightings sightings(&place);
    sightings.look(caster, camera, pose_from(SO3(Eigen::Quaterniond(R_W_C)), {x_m, 0.0, 1.5}), 1.0);
    return sightings.seen().front();
  };
  EXPECT_FALSE(seen_from(-2.5).first_s);
  const Sighting half = seen_from(0.0);
  EXPECT_EQ(half.first_s, 1.0);
  EXPECT_NEAR(half.centroid_O()->x(), 0.5 * (8.0 + std::sqrt(100.0 - 2.25)), 0.15) << "all of it: 11";
}

}  // namespace
}  // namespace pllit
