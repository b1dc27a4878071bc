// A visit to a hall, as a report may be asked to tell of it.
#pragma once

#include <nlohmann/json.hpp>

#include "pllit/report/report.hpp"

namespace pllit::test {

inline Time at(double seconds) { return Time(std::chrono::seconds(1'700'000'000)) + from_seconds(seconds); }

inline Anomaly finding(std::uint32_t id, double peak_change) {
  return {.id = id,
          .state = AnomalyState::confirmed,
          .position_W = {1.0, 2.0, 0.5},
          .covariance_m2 = 1e-4 * Matrix3d::Identity(),
          .extent_m = {0.2, 0.1, 0.3},
          .peak_change = peak_change,
          .mean_change = 0.5 * peak_change,
          .peak_sigmas = peak_change / 5.0,
          .mean_sigmas = peak_change / 10.0,
          .first_seen = at(10.0),
          .last_seen = at(20.0),
          .confirmed = at(11.0),
          .voxels = 12,
          .frames = 30,
          .views = 6,
          .confidence = 0.8};
}

/// A visit that walked ten metres along a wall.
inline ReportContent visit() {
  ReportContent content{.title = "Hall <3>", .has_images = true};
  content.thermal_map.fields = {{"intensity", {}}, {"images", {}}};
  for (int i = 0; i < 100; ++i) {
    content.trajectory.push_back({at(0.1 * i), pose_from(SO3::Identity(), Vector3d(0.1 * i, 0.0, 0.0))});
    content.thermal_map.points.emplace_back(0.1F * static_cast<float>(i), 2.0F, 1.0F);
    content.thermal_map.fields[0].values.push_back(static_cast<float>(i));
    content.thermal_map.fields[1].values.push_back(i < 50 ? 20.0F : 2.0F);
  }
  return content;
}

inline nlohmann::ordered_json run_json(int degraded = 0) {
  return {{"frames", 100},      {"length_m", 9.9},
          {"duration_s", 10.0}, {"status", "done"},
          {"program", "pllit"}, {"health", {{"good", 100 - degraded}, {"degraded", degraded}, {"lost", 0}}}};
}

}  // namespace pllit::test
