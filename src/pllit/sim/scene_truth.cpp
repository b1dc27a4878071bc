#include "pllit/sim/scene_truth.hpp"

#include <nlohmann/json.hpp>

#include "pllit/geometry/lie_json.hpp"
#include "pllit/sim/simulation.hpp"

namespace pllit {
namespace {

using Json = nlohmann::ordered_json;

Json camera_json(const Camera& camera) { return {camera.fx, camera.fy, camera.cx, camera.cy}; }

Json noise_json(const ImuNoise& noise) {
  return {{"gyro_density", noise.gyro_density},
          {"accel_density", noise.accel_density},
          {"gyro_bias_walk", noise.gyro_bias_walk},
          {"accel_bias_walk", noise.accel_bias_walk}};
}

Json unit_json(const LidarUnit& unit) {
  Json bend = Json::array();
  for (const Eigen::Vector2d& part : unit.bend_rad) bend.push_back({part.x(), part.y()});
  return {{"range_m", unit.range_m},
          {"line_range_m", unit.line_range_m},
          {"line_rad", unit.line_rad},
          {"bend_rad", bend},
          {"leading_edge", unit.leading_edge}};
}

Json number_or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json object_json(const SceneObject& object) {
  return {{"name", object.name},
          {"finding", object.finding},
          {"arrival", object.arrival},
          {"begins_s", object.begins_s},
          {"by_K", object.by_K},
          {"centroid_W", vector_json(object.centroid_W)},
          {"first_seen_s", number_or_null(object.first_seen_s)},
          {"nearest_m", number_or_null(object.nearest_m)},
          {"size_m", number_or_null(object.size_m)}};
}

}  // namespace

Json scene_json(const SceneTruth& truth, std::string_view address) {
  Json json{{"schema_version", 1},
            {"simulator_version", kSimulatorVersion},
            {"source", address},
            {"scene", name_of(truth.config.scene)},
            {"seed", truth.config.seed},
            {"rig", truth.rig},
            {"start_s", to_seconds(truth.start.time_since_epoch())},
            {"duration_s", truth.duration_s},
            {"length_m", truth.length_m}};
  if (truth.fit)
    json["distance_to_file"] = {{"position_rms_m", truth.fit->position_rms_m},
                                {"position_max_m", truth.fit->position_max_m},
                                {"rotation_rms_rad", truth.fit->rotation_rms_rad},
                                {"rotation_max_rad", truth.fit->rotation_max_rad}};
  json["T_I_C"] = {{"known", pose_json(truth.T_I_C_known)}, {"true", pose_json(truth.T_I_C)}};
  json["intrinsics_px"] = {{"known", camera_json(truth.camera_known)}, {"true", camera_json(truth.camera)}};
  json["lidar_unit"] = unit_json(truth.lidar);
  json["clock_late_s"] = {{"lidar", to_seconds(truth.lidar_clock)}, {"camera", to_seconds(truth.camera_clock)}};
  json["imu_noise"] = {{"known", noise_json(truth.imu_known)}, {"true", noise_json(truth.imu)}};
  json["objects"] = Json::array();
  for (const SceneObject& object : truth.objects) json["objects"].push_back(object_json(object));
  return json;
}

}  // namespace pllit
