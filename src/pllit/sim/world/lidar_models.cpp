#include "pllit/sim/world/lidar_models.hpp"

#include <limits>
#include <utility>

namespace pllit {
namespace {

// Assumed, all of them but where a source is named: makers give one figure of accuracy for noise and offsets together.

/// Accuracy of 1 cm as two sigma of a unit's offset.
constexpr UnitTolerance kPandarUnits{
    .range_m = 0.005, .line_range_m = 0.003, .line_rad = 0.02 * kDegree, .bend_rad = 0.02 * kDegree};
/// Accuracy of 2 to 3 cm likewise. Elevations of single lasers are known to be off by a tenth of a degree and more.
constexpr UnitTolerance kVelodyneUnits{
    .range_m = 0.01, .line_range_m = 0.005, .line_rad = 0.05 * kDegree, .bend_rad = 0.03 * kDegree};
/// As much of the directions' accuracy as goes into noise.
constexpr UnitTolerance kHorizonUnits{
    .range_m = 0.01, .line_range_m = 0.005, .line_rad = 0.02 * kDegree, .bend_rad = 0.05 * kDegree};
constexpr UnitTolerance kMid360Units{
    .range_m = 0.01, .line_range_m = 0.005, .line_rad = 0.02 * kDegree, .bend_rad = 0.1 * kDegree};

}  // namespace

RayLidar without_errors(RayLidar lidar) {
  lidar.min_range_m = lidar.range_sigma_m = lidar.range_step_m = lidar.beam_sigma_rad = 0.0;
  lidar.divergence_left_rad = lidar.divergence_up_rad = lidar.range_10_m = 0.0;
  lidar.max_range_m = std::numeric_limits<double>::infinity();
  lidar.unit = {};
  return lidar;
}

RayLidar pandar_xt32() {
  return {.name = "Hesai PandarXT-32",
          .pattern = pandar_xt32_pattern(),
          .min_range_m = 0.05,
          .max_range_m = 120.0,
          .range_sigma_m = 0.01,
          .range_step_m = 0.004,
          .beam_sigma_rad = 0.02 * kDegree,       // assumed: a ninth of the azimuth step
          .divergence_left_rad = 0.13 * kDegree,  // assumed, as is the next
          .divergence_up_rad = 0.09 * kDegree,
          .range_10_m = 80.0,
          .pulse_m = 0.5,  // assumed: a pulse of 3 ns
          .strongest_return = true,
          .counts_at_white = 100.0F,  // per cent, linear mapping
          .tolerance = kPandarUnits};
}

RayLidar velodyne_vlp16() {
  return {.name = "Velodyne VLP-16",
          .pattern = velodyne_vlp16_pattern(),
          .min_range_m = 0.5,
          .max_range_m = 100.0,
          .range_sigma_m = 0.015,  // "typically +-3 cm" taken as two sigma
          .range_step_m = 0.002,
          .beam_sigma_rad = 0.03 * kDegree,  // assumed
          .divergence_left_rad = 0.003,
          .divergence_up_rad = 0.0015,
          .range_10_m = 50.0,  // assumed: the data sheet gives no range for dark surfaces
          .pulse_m = 0.9,      // a pulse of 6 ns
          .strongest_return = true,
          .counts_at_white = 100.0F,  // diffuse surfaces 0 to 100, mirrors above
          .tolerance = kVelodyneUnits};
}

RayLidar velodyne_hdl64e() {
  return {.name = "Velodyne HDL-64E",
          .pattern = velodyne_hdl64e_pattern(),
          .min_range_m = 0.9,
          .max_range_m = 120.0,
          .range_sigma_m = 0.015,  // "below 2 cm"
          .range_step_m = 0.002,
          .beam_sigma_rad = 0.03 * kDegree,  // assumed
          .divergence_left_rad = 0.002,
          .divergence_up_rad = 0.002,
          .range_10_m = 50.0,  // "50 m (pavement, about 0.10)"
          .pulse_m = 0.75,     // a pulse of 5 ns
          .strongest_return = true,
          .counts_at_white = 255.0F,  // assumed: the full byte
          .tolerance = kVelodyneUnits};
}

RayLidar livox_horizon() {
  return {.name = "Livox Horizon",
          .pattern = livox_horizon_pattern(),
          .min_range_m = 0.5,
          .max_range_m = 260.0,
          .range_sigma_m = 0.02,
          .range_step_m = 0.001,
          .beam_sigma_rad = 0.05 * kDegree,
          .divergence_left_rad = 0.03 * kDegree,
          .divergence_up_rad = 0.28 * kDegree,
          .range_10_m = 90.0,
          .pulse_m = 0.6,             // assumed: a pulse of 4 ns
          .counts_at_white = 150.0F,  // diffuse surfaces 0 to 150, mirrors above
          .tolerance = kHorizonUnits};
}

RayLidar livox_mid360() {
  return {.name = "Livox Mid-360",
          .pattern = livox_mid360_pattern(),
          .min_range_m = 0.1,
          .max_range_m = 70.0,
          .range_sigma_m = 0.02,
          .range_step_m = 0.001,
          .beam_sigma_rad = 0.1 * kDegree,       // "below 0.15 degrees"
          .divergence_left_rad = 0.2 * kDegree,  // assumed, as is the next
          .divergence_up_rad = 0.2 * kDegree,
          .range_10_m = 40.0,
          .pulse_m = 0.6,  // assumed: a pulse of 4 ns
          .counts_at_white = 150.0F,
          .tolerance = kMid360Units};
}

Expected<RayLidar> lidar_model(const std::string& name) {
  if (name == "xt32") return pandar_xt32();
  if (name == "vlp16") return velodyne_vlp16();
  if (name == "hdl64e") return velodyne_hdl64e();
  if (name == "horizon") return livox_horizon();
  if (name == "mid360") return livox_mid360();
  return input_error("no LiDAR is called '" + name + "'; there are xt32, vlp16, hdl64e, horizon and mid360");
}

}  // namespace pllit
