#include "pllit/map/radiometry.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_states.hpp"

namespace pllit {
namespace {

/// The obvious twin: ten thousand small steps over Planck's law in frequency.
double integrated(double temperature_K) {
  constexpr double h = 6.62607015e-34, c = 299792458.0, k = 1.380649e-23;
  constexpr double from_Hz = c / 14e-6, to_Hz = c / 8e-6;
  constexpr int steps = 10000;
  const double step_Hz = (to_Hz - from_Hz) / steps;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) {
    const double f = from_Hz + (i + 0.5) * step_Hz;
    sum += 2.0 * h * f * f * f / (c * c) / std::expm1(h * f / (k * temperature_K)) * step_Hz;
  }
  return sum;
}

TEST(BandRadiance, IsPlancksLawIntegrated) {
  const BandRadiance band;
  for (const double kelvin : {200.0, 253.15, 293.15, 300.0, 330.7, 400.0, 812.3, 1400.0})
    EXPECT_NEAR(band.of(kelvin) / integrated(kelvin), 1.0, 2e-5) << kelvin;
}

TEST(BandRadiance, GivesTheTemperatureBack) {
  const BandRadiance band;
  for (double kelvin = 150.0; kelvin < 1490.0; kelvin += 13.7)
    EXPECT_NEAR(band.temperature_K(band.of(kelvin)), kelvin, 1e-6);
  EXPECT_EQ(band.temperature_K(-1.0), 100.0);
  EXPECT_EQ(band.temperature_K(1e9), 1500.0);
}

TEST(RadiometricEquation, ChangesNothingByDefault) {
  EXPECT_FALSE(Radiometry{}.corrects());
  const RadiometricEquation equation{Radiometry{}};
  for (const double kelvin : {250.0, 300.0, 400.0}) EXPECT_NEAR(equation.object_K(kelvin, 7.0), kelvin, 1e-6);
}

TEST(RadiometricEquation, IsTheInverseOfWhatACameraSees) {
  test::Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Radiometry radiometry{.emissivity = random.uniform(0.3, 1.0),
                                .reflected_K = random.uniform(260.0, 320.0),
                                .air_K = random.uniform(260.0, 320.0),
                                .absorbed_per_m = random.uniform(0.0, 0.02)};
    const RadiometricEquation equation(radiometry);
    const double object_K = random.uniform(270.0, 450.0), range_m = random.uniform(0.3, 20.0);
    EXPECT_NEAR(equation.object_K(equation.apparent_K(object_K, range_m), range_m), object_K, 1e-5);
  }
}

TEST(RadiometricEquation, AgreesWithTheIntegralsOfTheFormula) {
  const Radiometry radiometry{.emissivity = 0.6, .reflected_K = 285.0, .air_K = 291.0, .absorbed_per_m = 0.01};
  const double range_m = 8.0, through = std::exp(-0.08), object_K = 345.0;
  const double arrives =
      through * (0.6 * integrated(object_K) + 0.4 * integrated(285.0)) + (1.0 - through) * integrated(291.0);
  const double apparent_K = BandRadiance{}.temperature_K(arrives);
  EXPECT_LT(apparent_K, object_K - 10.0) << "the correction is not small";
  EXPECT_NEAR(RadiometricEquation(radiometry).object_K(apparent_K, range_m), object_K, 0.02);
}

TEST(RadiometricEquation, GivesATemperatureAsAnotherEmissivityHasIt) {
  const Radiometry as_black{.reflected_K = 295.0};
  const Radiometry as_metal{.emissivity = 0.4, .reflected_K = 295.0};
  const RadiometricEquation black(as_black), metal(as_metal);
  for (const double apparent_K : {299.0, 310.0, 350.0}) {
    const double found_K = black.object_K(apparent_K, 5.0);
    EXPECT_NEAR(black.with_emissivity(found_K, 0.4), metal.object_K(apparent_K, 5.0), 1e-6);
    EXPECT_NEAR(metal.with_emissivity(metal.object_K(apparent_K, 5.0), 1.0), apparent_K, 1e-6);
  }
}

TEST(RadiometricEquation, SeesNoHeatInWhatIsOnlyReflected) {
  const RadiometricEquation equation(Radiometry{.emissivity = 0.2, .reflected_K = 300.0});
  EXPECT_NEAR(equation.object_K(300.0, 3.0), 300.0, 1e-6);
  EXPECT_GT(equation.object_K(302.0, 3.0), 308.0);
}

}  // namespace
}  // namespace pllit
