// What a simulation knows and an estimator does not.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pllit/sim/config.hpp"
#include "pllit/sim/motion/fit.hpp"
#include "pllit/sim/rigs.hpp"

namespace pllit {

/// Something put into a place on purpose: to be found, or to be left alone.
struct SceneObject {
  std::string name;
  bool finding = false;
  std::string arrival;                     ///< "heated" or "brought"; "there" where it was hot from the start
  double begins_s = 0.0;                   ///< since the start
  double by_K = 0.0;                       ///< warmer than its surroundings or than it was
  Vector3d centroid_W = Vector3d::Zero();  ///< of the surface that the camera saw; if none, of what faces the path
  std::optional<double> first_seen_s{};    ///< first frame with enough unoccluded pixels
  std::optional<double> nearest_m{};       ///< from how near the camera saw it then
  std::optional<double> size_m{};          ///< edge of a hot box
};

struct SceneTruth {
  SimConfig config;
  std::string rig;
  Time start;
  double duration_s = 0.0, length_m = 0.0;
  std::optional<FitDistance> fit;
  SE3 T_I_C_known = SE3::Identity(), T_I_C = SE3::Identity();
  Camera camera_known, camera;
  LidarUnit lidar;
  Duration lidar_clock{0}, camera_clock{0};
  ImuNoise imu_known, imu;
  std::vector<SceneObject> objects;
};

/// Schema in docs/SIMULATOR.md; `address` is the simulation's.
nlohmann::ordered_json scene_json(const SceneTruth& truth, std::string_view address);

}  // namespace pllit
