#include "pllit/sim/world/ray_caster.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <thread>

#include "sim/world/test_place.hpp"

namespace pllit {
namespace {

using testing::EveryTriangle;
using testing::random_direction;
using testing::random_place;
using testing::ReadyPlace;

constexpr double kReach_m = 60.0;

std::vector<std::uint32_t> all_tiles(const ReadyPlace& place) {
  std::vector<std::uint32_t> indices(place.tiles_.size());
  std::iota(indices.begin(), indices.end(), 0U);
  return indices;
}

std::vector<Ray> random_rays(Random& random, const Vector3d& middle_W, int count) {
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Vector3d offset_m(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(1.0, 3.0));
    rays.push_back({.origin_W = middle_W + offset_m, .direction_W = random_direction(random)});
  }
  return rays;
}

/// What a static hit's texture place must be, whatever whole multiples were taken off: compared in the tile's frame.
void expect_same(const Hit& hit, const EveryTriangle::Nearest& expected) {
  EXPECT_NEAR(hit.range_m, expected.range_m, 1e-4);
  EXPECT_LT((hit.normal_W.cast<double>() - expected.normal_W).norm(), 1e-3);
  EXPECT_EQ(hit.surface, expected.surface);
  EXPECT_EQ(hit.warmer_K, expected.warmer_K);
  ASSERT_EQ(hit.actor, expected.actor);
  if (hit.actor != Hit::kStatic) {
    EXPECT_LT((hit.p_own.cast<double>() - expected.p_O).norm(), 1e-4);
  }
}

bool same(const Hit& a, const Hit& b) {
  if (!a || !b) return !a && !b;
  return a.range_m == b.range_m && a.normal_W == b.normal_W && a.p_own == b.p_own && a.surface == b.surface &&
         a.warmer_K == b.warmer_K && a.actor == b.actor;
}

class RandomWorlds : public ::testing::TestWithParam<int> {};

TEST_P(RandomWorlds, EmbreeFindsWhatTryingEveryTriangleFinds) {
  const Vector3d middle_W = GetParam() % 2 == 0 ? Vector3d(0.0, 0.0, 0.0) : Vector3d(3017.3, -2044.7, 12.25);
  const ReadyPlace place = random_place(static_cast<std::uint64_t>(GetParam()), middle_W);
  Random random(static_cast<std::uint64_t>(GetParam()), 1);
  RayCaster caster(place, kReach_m);
  int hits = 0, on_actors = 0;
  for (const double t_s : {-1.0, 0.5, 4.2, 7.7, 20.0}) {
    const std::vector<Ray> rays = random_rays(random, middle_W, 400);
    caster.move_to(middle_W, t_s);
    const EveryTriangle twin(place, all_tiles(place), t_s);
    for (const Ray& ray : rays) {
      const Hit hit = caster.cast(ray);
      const auto expected = twin.cast(ray, kReach_m);
      ASSERT_EQ(static_cast<bool>(hit), expected.has_value()) << ray.direction_W.transpose() << " at " << t_s;
      if (!hit) continue;
      expect_same(hit, *expected);
      ++hits;
      on_actors += hit.actor != Hit::kStatic ? 1 : 0;
    }
  }
  EXPECT_GT(hits, 800);
  EXPECT_GT(on_actors, 3);
}

TEST_P(RandomWorlds, ManyRaysAtOnceHitWhatEachHitsAlone) {
  const Vector3d middle_W(3017.3, -2044.7, 12.25);
  const ReadyPlace place = random_place(static_cast<std::uint64_t>(GetParam()), middle_W);
  Random random(static_cast<std::uint64_t>(GetParam()), 2);
  RayCaster caster(place, kReach_m);
  caster.move_to(middle_W, 4.2);
  for (const int count : {0, 1, 8, 403}) {
    const std::vector<Ray> rays = random_rays(random, middle_W, count);
    std::vector<Hit> hits(rays.size());
    caster.cast(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_TRUE(same(hits[i], caster.cast(rays[i]))) << i;
  }
}

TEST_P(RandomWorlds, TilesMadeAndDroppedOnTheWayGiveTheHitsOfEverythingAtOnce) {
  // A row of tiles much longer than the rays reach, there and back.
  ReadyPlace place = random_place(static_cast<std::uint64_t>(GetParam()), Vector3d::Zero());
  for (std::size_t i = 0; i < 9; ++i) place.tiles_[i].origin_W = Vector3d(40.0 * static_cast<double>(i), -20.0, 0.0);
  place.actors_.clear();
  constexpr double kShort_m = 30.0;
  RayCaster caster(place, kShort_m);
  const EveryTriangle twin(place, all_tiles(place), 0.0);
  place.made_ = 0;
  Random random(static_cast<std::uint64_t>(GetParam()), 3);
  for (int step = 0; step <= 80; ++step) {
    const Vector3d p_W(40.0 + 7.0 * (step < 40 ? step : 80 - step), 0.3 * step, 1.5);
    caster.move_to(p_W, 0.0);
    for (int i = 0; i < 20; ++i) {
      const Ray ray{.origin_W = p_W, .direction_W = random_direction(random)};
      const Hit hit = caster.cast(ray);
      const auto expected = twin.cast(ray, kShort_m);
      ASSERT_EQ(static_cast<bool>(hit), expected.has_value()) << "step " << step;
      if (hit) expect_same(hit, *expected);
    }
  }
  EXPECT_GT(place.made_, 9) << "tiles dropped behind are made again on the way back";
  EXPECT_LT(place.made_, 18) << "no tile is made more than once each way";
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomWorlds, ::testing::Range(0, 6));

TEST(RayCaster, GoingToAndFroAtATilesBorderMakesItOnce) {
  const ReadyPlace place = random_place(1, Vector3d::Zero());
  RayCaster caster(place, 10.0);
  for (int step = 0; step < 100; ++step) caster.move_to(Vector3d(step % 2 == 0 ? -12.0 : 12.0, 0.0, 1.0), 0.0);
  EXPECT_LE(place.made_, 9);
}

TEST(RayCaster, TexturePlacesAreTheSameFromWhereverTheyAreSeen) {
  const Vector3d middle_W(3017.3, -2044.7, 12.25);
  const ReadyPlace place = random_place(5, middle_W);
  RayCaster caster(place, kReach_m);
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    caster.move_to(middle_W, 20.0);
    const Vector3d origin_W = middle_W + Vector3d(0.0, 0.0, 2.0);
    const Ray ray{.origin_W = origin_W, .direction_W = random_direction(random)};
    const Hit hit = caster.cast(ray);
    if (!hit) continue;
    const Vector3d p_W = ray.origin_W + static_cast<double>(hit.range_m) * ray.direction_W;
    const Vector3d other_W = p_W + (hit.normal_W.cast<double>() + 0.3 * random_direction(random)).normalized() * 0.02;
    caster.move_to(other_W, 20.0);
    const Hit again = caster.cast({.origin_W = other_W, .direction_W = (p_W - other_W).normalized()});
    ASSERT_TRUE(again);
    EXPECT_LT((again.p_own - hit.p_own).norm(), 2e-4F);
    // Whole multiples of 1024 m apart, it is the place in the world.
    const Vector3d turns = (p_W - hit.p_own.cast<double>()) / 1024.0;
    EXPECT_LT((turns - turns.array().round().matrix()).norm() * 1024.0, 2e-4);
  }
}

TEST(RayCaster, ActorsAppearMoveAndVanishOnTime) {
  ReadyPlace place;
  place.surfaces_.resize(1);
  Actor actor{.name = "box", .mesh_O = {}, .path = {}, .heating = {}};
  testing::add_box(actor.mesh_O, -Vector3d::Ones(), Vector3d::Ones(), 0);
  const auto at = [](double x_m) { return pose_from(SO3::Identity(), Vector3d(x_m, 0.0, 0.0)); };
  actor.path = {{.at_s = 1.0, .T_W_O = at(10.0)}, {.at_s = 3.0, .T_W_O = at(20.0)}};
  actor.appears_s = 0.5;
  actor.vanishes_s = 4.0;
  place.actors_.push_back(actor);
  RayCaster caster(place, 100.0);
  const auto range_m = [&](double t_s) {
    caster.move_to(Vector3d::Zero(), t_s);
    return caster.cast({.origin_W = Vector3d::Zero(), .direction_W = Vector3d::UnitX()}).range_m;
  };
  EXPECT_LT(range_m(0.499), 0.0F);
  EXPECT_NEAR(range_m(0.5), 9.0, 1e-5);
  EXPECT_NEAR(range_m(1.0), 9.0, 1e-5);
  EXPECT_NEAR(range_m(1.5), 11.5, 1e-5);
  EXPECT_NEAR(range_m(3.9), 19.0, 1e-5);
  EXPECT_LT(range_m(4.0), 0.0F);
  EXPECT_NEAR(range_m(2.0), 14.0, 1e-5) << "time may go back";
}

TEST(RayCaster, BlockedAgreesWithTheNearestHitOnTheWay) {
  const ReadyPlace place = random_place(3, Vector3d::Zero());
  RayCaster caster(place, kReach_m);
  caster.move_to(Vector3d::Zero(), 3.0);
  Random random(3);
  int blocked = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3d from_W(random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0), 0.5 + 3.0 * random.uniform());
    const Vector3d to_W(random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0), 0.5 + 3.0 * random.uniform());
    const Hit hit = caster.cast({.origin_W = from_W, .direction_W = (to_W - from_W).normalized()});
    const bool expected = hit && hit.range_m < (to_W - from_W).norm();
    EXPECT_EQ(caster.blocked(from_W, to_W), expected);
    blocked += expected ? 1 : 0;
  }
  EXPECT_GT(blocked, 100);
  EXPECT_LT(blocked, 900);
}

TEST(RayCaster, ManyPointsAtOnceAreBlockedLikeEachAlone) {
  const ReadyPlace place = random_place(3, Vector3d::Zero());
  RayCaster caster(place, kReach_m);
  caster.move_to(Vector3d::Zero(), 3.0);
  Random random(4);
  const Vector3d way_W(9.0, -7.0, 3.0);
  std::vector<Vector3d> from_W;
  for (int i = 0; i < 203; ++i) from_W.emplace_back(random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0), 1.0);
  const auto answers = std::make_unique<bool[]>(from_W.size());
  caster.blocked(from_W, way_W, {answers.get(), from_W.size()});
  for (std::size_t i = 0; i < from_W.size(); ++i)
    EXPECT_EQ(answers[i], caster.blocked(from_W[i], from_W[i] + way_W)) << i;
  EXPECT_GT(std::count(answers.get(), answers.get() + from_W.size(), true), 20);
}

TEST(RayCaster, RaysATenthOfAMillimetreAroundSeamsDoNotLeaveAClosedRoom) {
  ReadyPlace place;
  place.surfaces_.resize(1);
  place.tiles_.resize(1);
  place.tiles_[0].origin_W = Vector3d(24.0, -48.0, 0.0);
  testing::add_box(place.tiles_[0].mesh, Vector3d(-11.3, -4.7, -0.2), Vector3d(9.1, 7.9, 3.3), 0);
  RayCaster caster(place, 50.0);
  caster.move_to(place.tiles_[0].origin_W, 0.0);
  Random random(7);
  int lost = 0;
  for (int i = 0; i < 400'000; ++i) {
    const Vector3d p_O(random.uniform(-9.0, 7.0), random.uniform(-3.0, 6.0), random.uniform(0.2, 3.0));
    // Where two triangles meet: on a wall's diagonal, or where it stands on the floor.
    const double along = random.uniform();
    const Vector3d seam_O(9.1, -4.7 + 12.6 * along, -0.2 + 3.5 * (i % 2 == 0 ? along : 0.0));
    const Vector3d way = seam_O + 1e-4 * random.gaussian3() - p_O;
    lost += caster.cast({place.tiles_[0].origin_W + p_O, way.normalized()}) ? 0 : 1;
  }
  EXPECT_EQ(lost, 0);
}

TEST(RayCaster, AWallSeenFromItsOwnSurfaceDoesNotBlock) {
  ReadyPlace place;
  place.surfaces_.resize(1);
  place.tiles_.resize(1);
  testing::add_sheet(place.tiles_[0].mesh, Vector3d(5, -5, -5), 10 * Vector3d::UnitY(), 10 * Vector3d::UnitZ(), 0);
  RayCaster caster(place, 50.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  EXPECT_FALSE(caster.blocked(Vector3d::Zero(), Vector3d(5.0, 1.0, 1.0)));
  EXPECT_TRUE(caster.blocked(Vector3d::Zero(), Vector3d(5.01, 1.0, 1.0)));
  EXPECT_FALSE(caster.blocked(Vector3d(5.0, 0.0, 0.0), Vector3d(5.0005, 0.0, 0.0)));
}

}  // namespace
}  // namespace pllit
