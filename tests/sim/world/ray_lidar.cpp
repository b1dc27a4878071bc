#include "pllit/sim/world/ray_lidar.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "sim/world/test_place.hpp"

namespace pllit {
namespace {

using testing::EveryTriangle;
using testing::ReadyPlace;

constexpr Time kStart(std::chrono::seconds(100));

/// A slow turn while walking.
std::function<SE3(Time)> walk(const Vector3d& from_W) {
  return [from_W](Time time) {
    const double t = to_seconds(time - kStart);
    return pose_from(exp_so3(Vector3d(0.1 * std::sin(3.0 * t), 0.1 * std::cos(2.0 * t), t)),
                     from_W + Vector3d(1.5 * t, 0.2 * std::sin(6.0 * t), 1.6));
  };
}

std::function<SE3(Time)> standing(const SE3& T_W_L) {
  return [T_W_L](Time) { return T_W_L; };
}

LidarScan scan_of(const ReadyPlace& place, const RayLidar& lidar, const std::function<SE3(Time)>& T_W_L,
                  std::int64_t index = 0, int threads = 1, std::uint64_t seed = 1) {
  RayCaster caster(place, 150.0);
  Arena arena(threads);
  return simulate_scan(lidar, {.place = place, .caster = caster, .T_W_L = T_W_L, .start = kStart, .seed = seed}, index,
                       arena);
}

/// A room of 20 by 16 by 5 m about the origin with a pillar.
ReadyPlace room(float reflectivity = 0.5F) {
  ReadyPlace place;
  place.surfaces_.resize(1);
  place.surfaces_[0].reflectivity = reflectivity;
  place.tiles_.resize(1);
  testing::add_box(place.tiles_[0].mesh, Vector3d(-10, -8, 0), Vector3d(10, 8, 5), 0);
  testing::add_box(place.tiles_[0].mesh, Vector3d(4, -1, 0), Vector3d(4.3, -0.7, 5), 0);
  return place;
}

class EveryRayLidar : public ::testing::TestWithParam<const char*> {
 protected:
  RayLidar lidar() const { return *lidar_model(GetParam()); }
};

TEST_P(EveryRayLidar, WithoutErrorsPointsLieOnTheSurfacesAlsoKilometresFromTheOrigin) {
  for (const Vector3d& middle_W : {Vector3d(0.0, 0.0, 0.0), Vector3d(2100.0, -2100.0, 40.0)}) {
    ReadyPlace place = testing::random_place(7, middle_W);
    place.actors_.clear();
    const LidarScan result = scan_of(place, without_errors(lidar()), walk(middle_W), 2);
    ASSERT_GT(result.points_L.size(), 1000U);
    ASSERT_EQ(result.rings.size(), result.points_L.size());
    ASSERT_EQ(result.offsets.size(), result.points_L.size());
    ASSERT_EQ(result.intensity.size(), result.points_L.size());
    const EveryTriangle twin(place, place.tiles_near(middle_W, 1000.0), 0.0);
    const auto T_W_L = walk(middle_W);
    for (std::size_t i = 0; i < result.points_L.size(); i += 37) {
      const SE3 pose = T_W_L(result.start + result.offsets[i]);
      const Vector3d p_L = result.points_L[i].cast<double>();
      const auto surface =
          twin.cast({.origin_W = pose.translation(), .direction_W = pose.rotation() * p_L.normalized()}, 1000.0);
      ASSERT_TRUE(surface);
      const double off_m = std::abs(p_L.norm() - surface->range_m);
      // Where the surface is grazed, a ray that differs by a rounding meets it elsewhere, but still on it.
      const double facing = std::abs(surface->normal_W.dot(pose.rotation() * p_L.normalized()));
      ASSERT_LT(off_m * facing, 2e-4) << "range " << p_L.norm();
    }
  }
}

TEST_P(EveryRayLidar, TheSameSeedGivesTheSameBytesWithOneThreadAndTwo) {
  const ReadyPlace place = testing::random_place(3, Vector3d::Zero());
  const LidarScan one = scan_of(place, lidar(), walk(Vector3d::Zero()), 5, 1);
  const LidarScan two = scan_of(place, lidar(), walk(Vector3d::Zero()), 5, 2);
  const LidarScan other = scan_of(place, lidar(), walk(Vector3d::Zero()), 5, 1, 2);
  ASSERT_GT(one.points_L.size(), 1000U);
  ASSERT_EQ(one.points_L.size(), two.points_L.size());
  const auto bytes = one.points_L.size() * sizeof(Vector3f);
  EXPECT_EQ(std::memcmp(one.points_L.data(), two.points_L.data(), bytes), 0);
  EXPECT_EQ(one.offsets, two.offsets);
  EXPECT_EQ(one.intensity, two.intensity);
  EXPECT_EQ(one.rings, two.rings);
  EXPECT_NE(one.points_L.front(), other.points_L.front());
}

TEST_P(EveryRayLidar, PointsComeInOrderOfTimeWithinTheRangesOfTheModel) {
  const ReadyPlace place = testing::random_place(2, Vector3d::Zero());
  const LidarScan result = scan_of(place, lidar(), walk(Vector3d::Zero()), 1);
  EXPECT_EQ(result.start, kStart + std::chrono::milliseconds(100));
  EXPECT_TRUE(std::ranges::is_sorted(result.offsets));
  for (std::size_t i = 0; i < result.points_L.size(); ++i) {
    ASSERT_GE(result.points_L[i].norm(), lidar().min_range_m - 1e-4);
    ASSERT_LE(result.points_L[i].norm(), lidar().max_range_m + 1e-4);
    ASSERT_GE(result.intensity[i], 0.0F);
    ASSERT_LE(result.intensity[i], 255.0F);
    ASSERT_EQ(result.intensity[i], std::round(result.intensity[i]));
  }
}

TEST_P(EveryRayLidar, OnAFacingWallTheRangeNoiseIsTheModels) {
  ReadyPlace place;
  place.surfaces_.resize(1);
  place.surfaces_[0].reflectivity = 0.8F;
  place.tiles_.resize(1);
  testing::add_sheet(place.tiles_[0].mesh, Vector3d(10, -10, -10), 20 * Vector3d::UnitY(), 20 * Vector3d::UnitZ(), 0);
  const LidarScan result = scan_of(place, lidar(), standing(SE3::Identity()));
  double sum2 = 0.0, sum = 0.0;
  int count = 0;
  for (const Vector3f& p : result.points_L) {
    if (std::abs(p.y()) > 2.0F || std::abs(p.z()) > 2.0F) continue;
    // Along the beam; at up to 16 degrees the beam noise adds little.
    const Vector3d p_L = p.cast<double>();
    const double error_m = p_L.norm() - 10.0 / p_L.normalized().x();
    sum += error_m;
    sum2 += error_m * error_m;
    ++count;
  }
  ASSERT_GT(count, 100);
  const double sigma_m = std::sqrt(sum2 / count);
  EXPECT_NEAR(sum / count, 0.0, 4.0 * sigma_m / std::sqrt(count) + 1e-4);
  EXPECT_NEAR(sigma_m, lidar().range_sigma_m, 0.15 * lidar().range_sigma_m + 10.0 * 0.15 * lidar().beam_sigma_rad);
}

INSTANTIATE_TEST_SUITE_P(Lidars, EveryRayLidar, ::testing::Values("xt32", "vlp16", "hdl64e", "horizon", "mid360"));

TEST(RayLidar, MixedPointsLieOnlyAtEdgesOfDepth) {
  ReadyPlace place;
  place.surfaces_.resize(1);
  place.tiles_.resize(1);
  // A wall, and 0.3 m before it a narrower one, whose edges are at y = -2 and 2.
  testing::add_sheet(place.tiles_[0].mesh, Vector3d(10, -9, -9), 18 * Vector3d::UnitY(), 18 * Vector3d::UnitZ(), 0);
  testing::add_sheet(place.tiles_[0].mesh, Vector3d(9.7, -2, -9), 4 * Vector3d::UnitY(), 18 * Vector3d::UnitZ(), 0);
  RayLidar lidar = pandar_xt32();
  lidar.range_sigma_m = lidar.beam_sigma_rad = 0.0;
  lidar.range_step_m = 0.0;
  const LidarScan result = scan_of(place, lidar, standing(SE3::Identity()));
  int mixed = 0, pure = 0;
  for (const Vector3f& p : result.points_L) {
    const bool between = p.x() > 9.72F && p.x() < 9.98F;
    (between ? mixed : pure) += 1;
    if (between) {
      const double from_edge_rad = std::abs(std::abs(std::atan2(p.y(), p.x())) - std::atan2(2.0, 9.7));
      ASSERT_LT(from_edge_rad, lidar.divergence_left_rad / 2.0);
    }
  }
  EXPECT_GT(mixed, 5);
  EXPECT_GT(pure, 100 * mixed);
  lidar.divergence_left_rad = lidar.divergence_up_rad = 0.0;
  for (const Vector3f& p : scan_of(place, lidar, standing(SE3::Identity())).points_L)
    ASSERT_TRUE(p.x() < 9.701F || p.x() > 9.999F) << "without divergence nothing is mixed";
}

TEST(RayLidar, ReturnsGetRarerWithRangeAndGrazing) {
  // A floor of dark asphalt, seen from 1.5 m: rings that meet it farther away also graze it more.
  ReadyPlace place;
  place.surfaces_.resize(1);
  place.surfaces_[0].reflectivity = 0.12F;
  place.tiles_.resize(1);
  testing::add_sheet(place.tiles_[0].mesh, Vector3d(-150, -150, -1.5), 300 * Vector3d::UnitX(), 300 * Vector3d::UnitY(),
                     0);
  const LidarScan result = scan_of(place, pandar_xt32(), standing(SE3::Identity()));
  std::vector<int> points(32, 0);
  for (const std::uint16_t line : result.rings) ++points[line];
  EXPECT_GT(points[31], 1990) << "16 degrees down, 5.4 m away";
  EXPECT_LT(points[16], 20) << "1 degree down, 86 m away";
  for (std::size_t line = 17; line < 32; ++line) EXPECT_GE(points[line] + 60, points[line - 1]) << line;
}

TEST(RayLidar, DarkWallsAreSeenLessFarThanBrightOnes) {
  const auto seen = [](double distance_m, float reflectivity) {
    ReadyPlace place;
    place.surfaces_.resize(1);
    place.surfaces_[0].reflectivity = reflectivity;
    place.tiles_.resize(1);
    const Vector3d corner(distance_m, -20.0, -20.0);
    testing::add_sheet(place.tiles_[0].mesh, corner, 40 * Vector3d::UnitY(), 40 * Vector3d::UnitZ(), 0);
    return scan_of(place, livox_mid360(), standing(SE3::Identity())).points_L.size();
  };
  EXPECT_GT(seen(30.0, 0.1F), 100U);
  EXPECT_LT(seen(60.0, 0.1F), 10U);
  EXPECT_GT(seen(60.0, 0.5F), 30U);
}

TEST(RayLidar, IntensityIsReflectivityTimesTheCosineOfIncidence) {
  const LidarScan result = scan_of(room(0.6F), pandar_xt32(), standing(pose_from(SO3::Identity(), Vector3d(0, 0, 2))));
  int checked = 0;
  for (std::size_t i = 0; i < result.points_L.size(); ++i) {
    const Vector3d p = result.points_L[i].cast<double>();
    if (std::abs(p.y() - 8.0) > 0.04 || std::abs(p.x()) > 9.5 || p.z() < -1.9 || p.z() > 2.9) continue;
    ++checked;
    const double expected = 60.0 * p.y() / p.norm();
    ASSERT_NEAR(result.intensity[i], expected, 0.06 * expected + 0.6);
  }
  EXPECT_GT(checked, 5000);
}

TEST(RayLidar, EveryPulseSeesMovingThingsWhereTheyAreAtItsOwnTime) {
  ReadyPlace place;
  place.surfaces_.resize(1);
  Actor car{.name = "car", .mesh_O = {}, .path = {}, .heating = {}};
  testing::add_box(car.mesh_O, Vector3d(-2, -1, -1), Vector3d(2, 1, 1), 0);
  // Past the rig at 20 m/s.
  car.path = {{.at_s = 0.0, .T_W_O = pose_from(SO3::Identity(), Vector3d(-20, 6, 0))},
              {.at_s = 2.0, .T_W_O = pose_from(SO3::Identity(), Vector3d(20, 6, 0))}};
  place.actors_.push_back(car);
  const LidarScan result = scan_of(place, without_errors(livox_mid360()), standing(SE3::Identity()), 9);
  ASSERT_GT(result.points_L.size(), 100U);
  double first_m = 1e9, last_m = -1e9;
  for (std::size_t i = 0; i < result.points_L.size(); ++i) {
    const double middle_m = -20.0 + 20.0 * (0.9 + to_seconds(result.offsets[i]));
    ASSERT_LT(std::abs(result.points_L[i].x() - middle_m), 2.0 + 20.0 * 0.0026) << "5 ms at a time";
    first_m = std::min(first_m, middle_m);
    last_m = std::max(last_m, middle_m);
  }
  EXPECT_GT(last_m - first_m, 0.4) << "it moves on during the scan";
}

}  // namespace
}  // namespace pllit
