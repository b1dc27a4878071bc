#include "pllit/sim/world/lidar_unit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pllit/sim/random.hpp"
#include "pllit/sim/world/lidar_patterns.hpp"
#include "pllit/sim/world/ray_lidar.hpp"
#include "sim/world/test_place.hpp"

namespace pllit {
namespace {

using testing::ReadyPlace;

/// Seen from the origin by a LiDAR without other errors than the unit's.
LidarScan scan_of(const ReadyPlace& place, const LidarUnit& unit, double divergence_rad = 0.0) {
  RayLidar lidar = without_errors(*lidar_model("xt32"));
  lidar.unit = unit;
  lidar.divergence_left_rad = lidar.divergence_up_rad = divergence_rad;
  RayCaster caster(place, 150.0);
  Arena arena(1);
  return simulate_scan(lidar,
                       {.place = place,
                        .caster = caster,
                        .T_W_L = [](Time) { return SE3::Identity(); },
                        .start = Time(std::chrono::seconds(1)),
                        .seed = 1},
                       0, arena);
}

ReadyPlace sheet(const Vector3d& corner_W, const Vector3d& one_W, const Vector3d& other_W) {
  ReadyPlace place;
  place.surfaces_.resize(1);
  place.surfaces_[0].reflectivity = 0.8F;
  place.tiles_.resize(1);
  testing::add_sheet(place.tiles_[0].mesh, corner_W, one_W, other_W, 0);
  return place;
}

/// A wall 10 m ahead.
ReadyPlace wall() { return sheet({10, -40, -40}, 80 * Vector3d::UnitY(), 80 * Vector3d::UnitZ()); }

TEST(LidarUnit, AddsItsOffsetsToEachRange) {
  LidarUnit unit{.range_m = 0.02, .line_range_m = std::vector<double>(32, 0.0), .line_rad = {}};
  unit.line_range_m[7] = -0.05;
  const LidarScan scan = scan_of(wall(), unit);
  ASSERT_GT(scan.points_L.size(), 5000U);
  for (std::size_t i = 0; i < scan.points_L.size(); ++i) {
    const Vector3d p_L = scan.points_L[i].cast<double>();
    EXPECT_NEAR(p_L.norm() - 10.0 / p_L.normalized().x(), scan.rings[i] == 7 ? -0.03 : 0.02, 1e-4);
  }
}

TEST(LidarUnit, SendsItsBeamsOtherwiseThanItReports) {
  LidarUnit unit;
  unit.bend_rad[1] = {0.01, 0.0};  // to the left as the sine of the azimuth: azimuths are reported too small
  for (const Vector3f& point_L : scan_of(wall(), unit).points_L) {
    const Vector3d p_L = point_L.cast<double>();
    if (std::abs(p_L.z()) > 0.5) continue;
    const double azimuth = std::atan2(p_L.y(), p_L.x()), truly = azimuth + 0.01 * std::sin(azimuth);
    if (std::abs(azimuth) < 1.2) {
      EXPECT_NEAR(p_L.head<2>().norm() * std::cos(truly), 10.0, 0.01) << azimuth;
    }
  }
}

TEST(LidarUnit, MeasuresSlantingSurfacesTooNearAndFacingOnesRight) {
  constexpr double divergence_rad = 0.004;
  LidarUnit unit;
  unit.leading_edge = 1.0;
  const ReadyPlace ground = sheet({-60, -60, -2}, 120 * Vector3d::UnitX(), 120 * Vector3d::UnitY());
  const double pulse_m = lidar_model("xt32")->pulse_m;
  int seen = 0;
  for (const Vector3f& point_L : scan_of(ground, unit, divergence_rad).points_L) {
    const Vector3d p_L = point_L.cast<double>(), way_L = p_L.normalized();
    const double truly_m = -2.0 / way_L.z(), slope = std::sqrt(1.0 / (way_L.z() * way_L.z()) - 1.0);
    const double expected_m = slant_bias_m(1.0, pulse_m, 0.25 * divergence_rad * truly_m * slope);
    if (truly_m > 50.0) continue;
    EXPECT_NEAR(truly_m - p_L.norm(), expected_m, 1e-3 + 0.01 * expected_m) << truly_m;
    ++seen;
  }
  EXPECT_GT(seen, 5000);
  for (const Vector3f& point_L : scan_of(wall(), unit, divergence_rad).points_L) {
    const Vector3d p_L = point_L.cast<double>();
    if (p_L.normalized().x() > 0.98) {
      EXPECT_NEAR(p_L.x(), 10.0, 1e-3);
    }
  }
}

TEST(LidarUnit, AStretchedPulseReachesHalfItsHeightEarlierByWhatTheWaveformSays) {
  // The waveform itself: a normal pulse, and one broadened by a patch of normal depth.
  const double sigma_m = 0.5 / (2.0 * std::sqrt(2.0 * std::numbers::ln2)), spread_m = 0.3;
  const auto half_height = [](double sigma) {
    double x = 0.0;
    while (std::exp(-0.5 * x * x / (sigma * sigma)) > 0.5) x -= 1e-5;
    return x;
  };
  EXPECT_NEAR(slant_bias_m(1.0, 0.5, spread_m), half_height(sigma_m) - half_height(std::hypot(sigma_m, spread_m)),
              1e-4);
  EXPECT_EQ(slant_bias_m(1.0, 0.5, 0.0), 0.0);
  EXPECT_EQ(slant_bias_m(0.0, 0.5, spread_m), 0.0);
}

TEST(LidarUnit, UnitsLieApartAsTheModelsTolerancesSay) {
  const UnitTolerance tolerance{.range_m = 0.01, .line_range_m = 0.004, .line_rad = 3e-4, .bend_rad = 1e-3};
  double range2 = 0.0, line2 = 0.0, bend2 = 0.0;
  constexpr int kUnits = 2000;
  for (std::uint64_t seed = 0; seed < kUnits; ++seed) {
    Random random(seed);
    const LidarUnit unit = drawn_unit(tolerance, 4, random);
    range2 += unit.range_m * unit.range_m;
    line2 += unit.line_rad[3] * unit.line_rad[3];
    const double azimuth = 2.0 * std::numbers::pi * random.uniform();
    const Beam beam{.direction_L = {std::cos(azimuth), std::sin(azimuth), 0.0},
                    .line = 9};  // no such line: the bend alone
    bend2 += 0.5 * unit.aside_rad(beam).squaredNorm();
    EXPECT_GE(unit.leading_edge, 0.3);
    EXPECT_LE(unit.leading_edge, 0.7);
  }
  EXPECT_NEAR(std::sqrt(range2 / kUnits), 0.01, 0.0007);
  EXPECT_NEAR(std::sqrt(line2 / kUnits), 3e-4, 2e-5);
  EXPECT_NEAR(std::sqrt(bend2 / kUnits), 1e-3, 7e-5);
}

}  // namespace
}  // namespace pllit
