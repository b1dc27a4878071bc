// A simulated drive up a street, back on the other lane, and up again, as keyframes at true poses.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pllit/loop/keyframe.hpp"
#include "pllit/sim/simulation.hpp"

namespace pllit::test {

/// Poses along the drive every 0.1 s: `straight_m` up, a half turn to the left that ends `lane_m` aside, back, another
/// half turn, and up again.
inline Trajectory up_and_back_path(double straight_m, double lane_m, double speed_mps) {
  const double radius_m = 0.5 * lane_m, turn_m = M_PI * radius_m;
  const double whole_m = 3.0 * straight_m + 2.0 * turn_m;
  Trajectory path;
  for (int i = 0; 0.1 * i * speed_mps <= whole_m; ++i) {
    double s = 0.1 * i * speed_mps;
    Vector3d p = Vector3d::Zero();
    double heading = 0.0;
    if (s < straight_m) {
      p.x() = s;
    } else if ((s -= straight_m) < turn_m) {
      heading = s / radius_m;
      p = Vector3d(straight_m + radius_m * std::sin(heading), radius_m * (1.0 - std::cos(heading)), 0.0);
    } else if ((s -= turn_m) < straight_m) {
      heading = M_PI;
      p = Vector3d(straight_m - s, lane_m, 0.0);
    } else if ((s -= straight_m) < turn_m) {
      heading = M_PI + s / radius_m;
      p = Vector3d(-radius_m * std::sin(s / radius_m), radius_m * (1.0 + std::cos(s / radius_m)), 0.0);
    } else {
      p.x() = s - turn_m;
    }
    path.push_back({Time(std::chrono::seconds(1'700'000'000)) + from_seconds(0.1 * i),
                    pose_from(exp_so3(Vector3d(0.0, 0.0, heading)), p)});
  }
  return path;
}

/// Keyframes every two metres of a simulation, each with the scans since the one before, de-skewed and placed by the
/// truth. Every `nth` point is used.
inline std::vector<LoopKeyframe> true_keyframes(Simulation& simulation, std::size_t nth) {
  constexpr double spacing_m = 2.0, scan_every_m = 0.5, voxel_m = 0.3;
  std::vector<LoopKeyframe> keyframes;
  std::vector<Vector3f> points_W;
  Vector3d last_p_W = Vector3d::Zero(), last_scan_W = Vector3d::Constant(1e9);
  double way_m = 0.0;
  while (auto event = simulation.next().value()) {
    const auto* scan = std::get_if<LidarScan>(&event->data);
    if (!scan || scan->offsets.empty()) continue;
    const SE3 T_W_I = simulation.motion().at(scan->end()).T_W_I;
    if (!keyframes.empty()) way_m += (T_W_I.translation() - last_p_W).norm();
    last_p_W = T_W_I.translation();
    if ((last_p_W - last_scan_W).norm() < scan_every_m) continue;
    last_scan_W = last_p_W;
    for (std::size_t i = 0; i < scan->points_L.size(); i += nth) {
      const SE3 T_W_L = simulation.motion().at(scan->start + scan->offsets[i]).T_W_I * simulation.rig().T_I_L;
      if (scan->points_L[i].norm() < 60.0F)
        points_W.push_back(T_W_L.act(scan->points_L[i].cast<double>()).cast<float>());
    }
    if (!keyframes.empty() && way_m - keyframes.back().way_m < spacing_m) continue;
    LoopKeyframe keyframe{.time = scan->end(), .T_O_I = T_W_I, .way_m = way_m, .cloud = {}};
    keyframe.up_I = T_W_I.rotation().transpose() * Vector3d::UnitZ();
    keyframe.up_sigma_rad = 1e-3;
    keyframe.step_covariance.diagonal() << Vector3d::Constant(1e-8), Vector3d::Constant(1e-6);
    const SE3 T_I_W = T_W_I.inverse();
    for (Vector3f& p : points_W) p = T_I_W.act(p.cast<double>()).cast<float>();
    keyframe.cloud = CompactCloud(thinned(points_W, voxel_m));
    keyframes.push_back(std::move(keyframe));
    points_W.clear();
  }
  return keyframes;
}

/// The whole drive by a rig, 60 m up: about 210 m.
inline std::vector<LoopKeyframe> up_and_back(SimConfig::RigName rig, std::uint64_t seed) {
  SimConfig config;
  config.scene = SceneKind::street;
  config.rig = rig;
  config.seed = seed;
  config.images = SimConfig::Images::none;
  config.motion = "up_and_back";
  auto simulation = Simulation::make(config, up_and_back_path(60.0, 7.0, 7.0));
  EXPECT_TRUE(simulation.has_value()) << simulation.error().message;
  return true_keyframes(*simulation, 6);
}

}  // namespace pllit::test
