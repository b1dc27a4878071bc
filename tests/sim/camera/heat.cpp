#include "pllit/sim/camera/heat.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "sim/camera/test_place.hpp"

namespace pllit {
namespace {

constexpr float kPixel_rad = 0.001F;
const Ray kAhead{Vector3d::Zero(), Vector3d::UnitY()};

float temperature_ahead_K(const TestPlace& place, double t_s) {
  RayCaster caster(place, 50.0);
  caster.move_to(Vector3d::Zero(), t_s);
  const ThermalBand band;
  const Heat heat(place, band, t_s, kPixel_rad);
  const Hit hit = caster.cast(kAhead);
  return heat.temperature_K(hit, heat.in_sun(caster, kAhead, hit));
}

float radiance_ahead(const TestPlace& place) {
  RayCaster caster(place, 50.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  const ThermalBand band;
  const Heat heat(place, band, 0.0, kPixel_rad);
  const std::array rays{kAhead};
  const std::array hits{caster.cast(kAhead)};
  std::array<float, 1> radiance{};
  heat.shade(caster, rays, hits, 1, radiance);
  return radiance[0];
}

TestPlace one_wall(const Surface& surface) { return two_walls(10.0, surface, surface); }

TEST(ThermalBand, HoldsTheKnownShareOfABlackBodysRadiance) {
  const ThermalBand band;
  // Fractions of sigma T^4 / pi between 8 and 14 um, from tables of the blackbody function.
  constexpr double stefan = 5.670374e-8, pi = 3.14159265358979;
  EXPECT_NEAR(band.radiance(300.0F) / (stefan * std::pow(300.0, 4) / pi), 0.376, 0.003);
  EXPECT_NEAR(band.radiance(600.0F) / (stefan * std::pow(600.0, 4) / pi), 0.2637, 0.003);
}

TEST(ThermalBand, GrowsWithTemperatureAndItsSlopeIsItsDerivative) {
  const ThermalBand band;
  for (float kelvin = 200.0F; kelvin < 1000.0F; kelvin += 7.3F) {
    EXPECT_GT(band.slope(kelvin), 0.0F);
    EXPECT_NEAR(band.slope(kelvin), (band.radiance(kelvin + 5.0F) - band.radiance(kelvin - 5.0F)) / 10.0F, 0.002F);
  }
}

TEST(Heat, AWallIsAsMuchWarmerThanTheAirAsItsSurfaceAndMeshSay) {
  TestPlace place = one_wall(plain_surface(7.0F));
  for (float& warmer_K : place.mesh_.warmer_K) warmer_K = 1.5F;
  EXPECT_NEAR(temperature_ahead_K(place, 0.0), place.climate_.air_K + 8.5, 1e-3);
}

TEST(Heat, FollowsItsShareOfTheAirsDrift) {
  Surface surface = plain_surface(7.0F);
  surface.follows_air = 0.25F;
  TestPlace place = one_wall(surface);
  place.climate_.air_drift_Kph = 8.0;
  EXPECT_NEAR(temperature_ahead_K(place, 1800.0) - temperature_ahead_K(place, 0.0), 1.0, 1e-3);
}

TEST(Heat, AHeatedActorApproachesItsNewTemperatureExponentially) {
  const TestPlace place = room();
  RayCaster caster(place, 50.0);
  const ThermalBand band;
  const Ray at_kettle{Vector3d::Zero(), Vector3d(0.5, 3.0, 0.0).normalized()};
  for (const double t_s : {0.0, 10.0, 20.0, 70.0, 400.0}) {
    caster.move_to(Vector3d::Zero(), t_s);
    const Hit hit = caster.cast(at_kettle);
    ASSERT_EQ(hit.actor, 0U);
    const double expected_K = place.climate_.air_K + 2.0 + 70.0 * (1.0 - std::exp(-std::max(0.0, t_s - 10.0) / 60.0));
    EXPECT_NEAR(Heat(place, band, t_s, kPixel_rad).temperature_K(hit, false), expected_K, 1e-3);
  }
}

TEST(Heat, TheSunWarmsWhatItMeetsAndNothingInAShadow) {
  Surface surface = plain_surface(0.0F);
  surface.sun_K = 20.0F;
  TestPlace place = one_wall(surface);
  place.climate_.sun = 0.5;
  place.climate_.to_sun_W = Vector3d(0.0, -1.0, 1.0).normalized();
  EXPECT_NEAR(temperature_ahead_K(place, 0.0), place.climate_.air_K + 0.5 * 20.0 * std::sqrt(0.5), 1e-3);
  add_box(place.mesh_, {-1, -1, 2}, {1, 3, 2.5F}, 0);
  EXPECT_NEAR(temperature_ahead_K(place, 0.0), place.climate_.air_K, 1e-3);
}

TEST(Heat, WhatASurfaceDoesNotEmitItReflects) {
  const ThermalBand band;
  Surface surface = plain_surface(30.0F);
  surface.emissivity = 0.4F;
  const TestPlace dull = one_wall(surface);
  const auto air_K = static_cast<float>(dull.climate_.air_K);
  EXPECT_NEAR(radiance_ahead(dull), 0.4F * band.radiance(air_K + 30.0F) + 0.6F * band.radiance(air_K), 1e-3F);
  surface.mirror = 1.0F;
  TestPlace mirror = one_wall(surface);
  mirror.surfaces_.push_back(plain_surface(100.0F));
  add_box(mirror.mesh_, {-2, -5, -2}, {2, -4, 2}, 2);  // behind the observer
  EXPECT_NEAR(radiance_ahead(mirror), 0.4F * band.radiance(air_K + 30.0F) + 0.6F * band.radiance(air_K + 100.0F),
              1e-3F);
}

TEST(Heat, TheSkyIsColdestAtTheZenithAndAsWarmAsTheAirAtTheHorizon) {
  const TestPlace place = one_wall(plain_surface(0.0F));
  const ThermalBand band;
  const Heat heat(place, band, 0.0, kPixel_rad);
  EXPECT_NEAR(heat.sky_K(Vector3f::UnitX()), place.climate_.air_K, 0.01);
  EXPECT_LT(heat.sky_K(Vector3f::UnitZ()), place.climate_.air_K - 15.0);
  EXPECT_GE(heat.sky_K(Vector3f::UnitZ()), place.climate_.sky_K - 0.01);
}

}  // namespace
}  // namespace pllit
