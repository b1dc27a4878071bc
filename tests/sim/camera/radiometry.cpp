// The simulator's raw counts, turned into temperatures: what it knows of emissivities is found again.
#include "pllit/map/radiometry.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "pllit/sim/camera/thermal_camera.hpp"
#include "sim/camera/faultless_camera.hpp"
#include "sim/camera/test_place.hpp"

namespace pllit {
namespace {

/// Apparent temperature in the middle of the image, K, by the counts' definition and the simulator's own band.
double apparent_ahead_K(const Place& place) {
  const ThermalCameraModel model = faultless_camera(150.0);
  Arena arena(1);
  RayCaster caster(place, 60.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  ThermalCamera camera(model, place, Time{}, 7);
  const auto at_rest = [](Time) { return looking_along_y(); };
  const cv::Mat counts = camera.capture(caster, at_rest, Time{}, arena).counts;
  const double count = counts.at<std::uint16_t>(counts.rows / 2, counts.cols / 2);
  const ThermalBand band;
  const double slope = static_cast<double>(band.slope(300.0F));
  const double radiance =
      static_cast<double>(band.radiance(300.0F)) + slope * (count - model.counts_at_300K) / model.counts_per_K;
  return BandRadiance{}.temperature_K(radiance);
}

TEST(Radiometry, FindsTheTrueTemperatureOfSimulatedSurfaces) {
  for (const double emissivity : {0.95, 0.7, 0.4}) {
    Surface surface = plain_surface(25.0F);
    surface.emissivity = static_cast<float>(emissivity);
    const TestPlace place = two_walls(10.0, surface, surface);
    const double air_K = place.climate_.air_K, apparent_K = apparent_ahead_K(place);
    const RadiometricEquation equation({.emissivity = emissivity, .reflected_K = air_K});
    EXPECT_NEAR(equation.object_K(apparent_K, 4.0), air_K + 25.0, 0.02 / emissivity);
    EXPECT_LT(apparent_K, air_K + 25.0 * (emissivity + 0.06)) << "as it shows, it is cooler";
  }
}

}  // namespace
}  // namespace pllit
