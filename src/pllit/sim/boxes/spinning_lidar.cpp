#include "pllit/sim/boxes/spinning_lidar.hpp"

#include <cmath>
#include <numbers>
#include <optional>

namespace pllit {
namespace {

LidarPattern even_rings(int rings, double lowest_deg, double highest_deg, int azimuth_steps) {
  LidarPattern pattern{.elevations_rad = {}, .azimuth_steps = azimuth_steps, .period = std::chrono::milliseconds(100)};
  for (int ring = 0; ring < rings; ++ring) {
    const double elevation_deg = lowest_deg + (highest_deg - lowest_deg) * ring / (rings - 1);
    pattern.elevations_rad.push_back(elevation_deg * std::numbers::pi / 180.0);
  }
  return pattern;
}

/// The vertical fan of rays that leaves the LiDAR at one azimuth, in L.
struct Fan {
  double cos_azimuth, sin_azimuth;

  Vector3d left_L() const { return {-sin_azimuth, cos_azimuth, 0.0}; }
  /// The unit vector in the fan at an elevation given by its cosine and sine.
  Vector3d ray_L(double cos_elevation, double sin_elevation) const {
    return {cos_elevation * cos_azimuth, cos_elevation * sin_azimuth, sin_elevation};
  }
};

}  // namespace

LidarPattern ring32_pattern() { return even_rings(32, -16.0, 15.0, 2000); }
LidarPattern ring16_pattern() { return even_rings(16, -15.0, 15.0, 1000); }

LidarScan simulate_scan(const SpinningLidar& lidar, const PlanesWorld& world, const Motion& motion, Time start,
                        Random random) {
  const LidarPattern& pattern = lidar.pattern;
  const LidarModel& model = lidar.model;
  LidarScan scan{.start = start, .points_L = {}, .offsets = {}, .intensity = {}};
  for (int step = 0; step < pattern.azimuth_steps; ++step) {
    const Duration offset = step * pattern.period / pattern.azimuth_steps;
    const double azimuth = 2.0 * std::numbers::pi * step / pattern.azimuth_steps;
    const Fan fan{std::cos(azimuth), std::sin(azimuth)};
    const SE3 T_W_L = motion.at(start + offset).T_W_I * lidar.T_I_L;
    const Matrix3d R_W_L = T_W_L.rotation();
    const Vector3d origin_W = T_W_L.translation();
    // Eight sigma: Box-Muller on 53 bits reaches 8.6, so a ray leaves this slack about once in 1e15.
    const auto in_fan = world.near_plane(origin_W, R_W_L * fan.left_L(), 8.0 * model.beam_sigma_rad + 1e-9);
    for (const double elevation : pattern.elevations_rad) {
      const double cos_elevation = std::cos(elevation), sin_elevation = std::sin(elevation);
      const Vector3d ray_L = fan.ray_L(cos_elevation, sin_elevation), up_L = fan.ray_L(-sin_elevation, cos_elevation);
      const double left = model.beam_sigma_rad * random.gaussian(), up = model.beam_sigma_rad * random.gaussian();
      const double range_error_m = model.range_sigma_m * random.gaussian();
      const Vector3d direction_W = R_W_L * (ray_L + left * fan.left_L() + up * up_L).normalized();
      const std::optional<RayHit> hit = world.cast(origin_W, direction_W, model.max_range_m, in_fan);
      if (!hit) continue;
      const double range_m = hit->range_m + range_error_m;
      if (range_m < model.min_range_m || range_m > model.max_range_m) continue;
      scan.points_L.push_back((range_m * ray_L).cast<float>());
      scan.offsets.push_back(offset);
      const double brightness = 255.0 * world.rectangles()[hit->rectangle].reflectivity * hit->cos_incidence;
      scan.intensity.push_back(static_cast<float>(brightness));
    }
  }
  return scan;
}

}  // namespace pllit
