#include "pllit/sim/world/echoes.hpp"

#include <gtest/gtest.h>

#include "sim/world/test_place.hpp"

namespace pllit {
namespace {

using testing::ReadyPlace;

Surface matt(float reflectivity) {
  Surface surface;
  surface.reflectivity = reflectivity;
  return surface;
}

/// A wall at some distance across the x axis.
ReadyPlace place_with_wall(double distance_m, const Surface& surface) {
  ReadyPlace place;
  place.surfaces_ = {surface, matt(0.8F)};
  place.tiles_.resize(1);
  testing::add_sheet(place.tiles_[0].mesh, Vector3d(distance_m, -50, -50), 100 * Vector3d::UnitY(),
                     100 * Vector3d::UnitZ(), 0);
  return place;
}

/// What a lidar reports of one pulse along a direction, whole or in shares of equal power along several.
std::optional<Echo> reported(const ReadyPlace& place, const RayLidar& lidar,
                             const std::vector<Vector3d>& directions_W) {
  RayCaster caster(place, 300.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  Echoes echoes;
  for (const Vector3d& direction_W : directions_W) {
    const Ray ray{.origin_W = Vector3d::Zero(), .direction_W = direction_W.normalized()};
    echoes.add(caster, place.surfaces_, ray, caster.cast(ray), 1.0 / static_cast<double>(directions_W.size()));
  }
  return echoes.reported(lidar, 0.0);
}

TEST(Echoes, AFacingWallGivesItsRangeAndReflectivity) {
  const auto echo = reported(place_with_wall(12.0, matt(0.4F)), pandar_xt32(), {Vector3d::UnitX()});
  ASSERT_TRUE(echo);
  EXPECT_NEAR(echo->range_m, 12.0, 1e-5);
  EXPECT_NEAR(echo->brightness, 0.4, 1e-6);
}

TEST(Echoes, AThirdOfTheSpotOnANearerWallMovesThePointTowardsIt) {
  ReadyPlace place = place_with_wall(12.0, matt(0.5F));
  testing::add_sheet(place.tiles_[0].mesh, Vector3d(11.8, 0.001, -50), 50 * Vector3d::UnitY(), 100 * Vector3d::UnitZ(),
                     0);
  const std::vector<Vector3d> spot{{1, 0.001, 0}, {1, 0, 0}, {1, -0.001, 0}};
  const auto mixed = reported(place, pandar_xt32(), spot);
  ASSERT_TRUE(mixed);
  EXPECT_NEAR(mixed->range_m, 12.0 - 0.2 / 3.0, 0.005);
}

TEST(Echoes, WallsFartherApartThanThePulseAreNotMixed) {
  ReadyPlace place = place_with_wall(12.0, matt(0.5F));
  testing::add_sheet(place.tiles_[0].mesh, Vector3d(9.0, 0.001, -50), 50 * Vector3d::UnitY(), 100 * Vector3d::UnitZ(),
                     1);
  place.surfaces_[1] = matt(0.05F);
  const std::vector<Vector3d> spot{{1, 0.001, 0}, {1, 0, 0}, {1, -0.001, 0}};
  RayLidar lidar = pandar_xt32();
  const auto strongest = reported(place, lidar, spot);
  ASSERT_TRUE(strongest);
  EXPECT_NEAR(strongest->range_m, 12.0, 1e-4);
  lidar.strongest_return = false;
  const auto first = reported(place, lidar, spot);
  ASSERT_TRUE(first);
  EXPECT_NEAR(first->range_m, 9.0, 1e-4);
}

TEST(Echoes, TheRatedRangeIsWhereATenPerCentSurfaceIsSeenNineTimesInTen) {
  RayLidar lidar = pandar_xt32();
  const ReadyPlace place = place_with_wall(lidar.range_10_m, matt(0.1F));
  RayCaster caster(place, 300.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  const Ray ray{.origin_W = Vector3d::Zero(), .direction_W = Vector3d::UnitX()};
  const Hit hit = caster.cast(ray);
  Random random(4);
  int seen = 0;
  for (int i = 0; i < 4000; ++i) {
    Echoes echoes;
    echoes.add(caster, place.surfaces_, ray, hit, 1.0);
    seen += echoes.reported(lidar, random.gaussian()) ? 1 : 0;
  }
  EXPECT_NEAR(seen / 4000.0, 0.9, 0.02);
}

TEST(Echoes, PowerFallsWithTheSquareOfTheRangeAndTheCosineOfIncidence) {
  const RayLidar lidar = pandar_xt32();
  const auto seen = [&](double distance_m, float reflectivity, double slant_rad) {
    const Vector3d direction_W(std::cos(slant_rad), std::sin(slant_rad), 0.0);
    return reported(place_with_wall(distance_m * std::cos(slant_rad), matt(reflectivity)), lidar, {direction_W})
        .has_value();
  };
  EXPECT_TRUE(seen(70.0, 0.1F, 0.0));
  EXPECT_FALSE(seen(100.0, 0.1F, 0.0));
  EXPECT_TRUE(seen(100.0, 0.25F, 0.0));
  EXPECT_FALSE(seen(70.0, 0.1F, 1.0));
  EXPECT_TRUE(seen(30.0, 0.1F, 1.0));
}

TEST(Echoes, AMirrorShowsWhatItReflectsAtTheLengthOfTheWholeWay) {
  Surface glass = matt(0.02F);
  glass.mirror = 0.9F;
  ReadyPlace place;
  place.surfaces_ = {glass, matt(0.8F)};
  place.tiles_.resize(1);
  // Glass at 45 degrees through (10, 0, 0) turns the x axis to the y axis, where a wall stands at y = 5.
  testing::add_sheet(place.tiles_[0].mesh, Vector3d(5, -5, -5), Vector3d(10, 10, 0), 10 * Vector3d::UnitZ(), 0);
  testing::add_sheet(place.tiles_[0].mesh, Vector3d(5, 5, -5), 10 * Vector3d::UnitX(), 10 * Vector3d::UnitZ(), 1);
  const auto ghost = reported(place, pandar_xt32(), {Vector3d::UnitX()});
  ASSERT_TRUE(ghost);
  EXPECT_NEAR(ghost->range_m, 15.0, 2e-3);
  EXPECT_NEAR(ghost->brightness, 0.9 * 0.9 * 0.8, 1e-3);
}

TEST(Echoes, AMirrorThatMirrorsTheSkyGivesNothingUnlessItIsNear) {
  Surface glass = matt(0.05F);
  glass.mirror = 0.9F;
  EXPECT_FALSE(reported(place_with_wall(30.0, glass), pandar_xt32(), {Vector3d(1.0, 0.3, 0.0)}));
  EXPECT_TRUE(reported(place_with_wall(3.0, glass), pandar_xt32(), {Vector3d(1.0, 0.3, 0.0)}));
  EXPECT_TRUE(reported(place_with_wall(30.0, glass), pandar_xt32(), {Vector3d(1.0, 0.0, 0.0)})) << "head on it dazzles";
}

}  // namespace
}  // namespace pllit
