#include "summary.hpp"

#include <sys/resource.h>

#include <format>
#include <numbers>

#include "findings.hpp"
#include "pllit/geometry/lie_json.hpp"
#include "program.hpp"

namespace pllit::app {
namespace {

using Json = nlohmann::ordered_json;

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace

Json summary_json(const RunSummary& summary) {
  Json json{{"schema_version", kSchemaVersion},
            {"frames", summary.frames},
            {"duration_s", summary.duration_s},
            {"length_m", summary.length_m},
            {"real_time_factor", summary.real_time_factor()},
            {"interrupted", summary.interrupted}};
  const Distribution& ms = summary.frame_ms;
  json["frame_ms"] = {
      {"mean", ms.mean()}, {"p50", ms.percentile(0.5)}, {"p99", ms.percentile(0.99)}, {"max", ms.max()}};
  for (std::size_t i = 0; i < stage_names.size(); ++i)
    json["stage_ms"][std::string(stage_names[i])] = {{"mean", summary.stage_ms[i].mean()},
                                                     {"p99", summary.stage_ms[i].percentile(0.99)}};
  json["peak_memory_mb"] = peak_memory_mb();
  json["health"] = {
      {"state", name_of(summary.final_state)},    {"initialising", summary.count(HealthState::initialising)},
      {"good", summary.count(HealthState::good)}, {"degraded", summary.count(HealthState::degraded)},
      {"lost", summary.count(HealthState::lost)}, {"doubts", summary.doubts()}};
  json["start"] = summary.start ? summary.start->report : "not started";
  json["notes"] = summary.notes;
  return json;
}

Json camera_json(const RefinedMount& mount, const Rig& rig) {
  constexpr double deg = 180.0 / std::numbers::pi;
  const MountVector moved = boxminus(mount.mean, {.T_I_C = rig.T_I_C}),
                    sigmas = mount.covariance.diagonal().cwiseSqrt();
  const auto sizes = [](const MountVector& error) -> Json {
    return {{"turn_deg", deg * error.head<3>().norm()},
            {"shift_m", error.segment<3>(mount_index::p).norm()},
            {"delay_s", error[mount_index::delay]},
            {"depth_stretch", error[mount_index::depth]}};
  };
  return {{"T_I_C", pose_json(mount.mean.T_I_C)},
          {"delay_s", to_seconds(rig.camera_delay) + mount.mean.delay_s},
          {"moved", sizes(moved)},
          {"sigma", sizes(sigmas)}};
}

std::string summary_text(const Json& json) {
  const Json& health = json["health"];
  std::string text = std::format(
      "frames      {} over {:.1f} s, {:.1f} m\n"
      "speed       {:.1f} x real time; a frame takes {:.1f} ms (p99 {:.1f}); peak memory {:.0f} MB\n"
      "health      {} at the end; frames good {}, degraded {}, lost {}\n"
      "start       {}\n",
      json["frames"].get<int>(), json["duration_s"].get<double>(), json["length_m"].get<double>(),
      json["real_time_factor"].get<double>(), json["frame_ms"]["mean"].get<double>(),
      json["frame_ms"]["p99"].get<double>(), json["peak_memory_mb"].get<double>(), health["state"].get<std::string>(),
      health["good"].get<int>(), health["degraded"].get<int>(), health["lost"].get<int>(),
      json["start"].get<std::string>());
  if (const auto doubts = health["doubts"].get<std::string>(); !doubts.empty())
    text += std::format("doubts      {} ({})\n", doubts,
                        json["status"] == "done" ? "therefore exit code 3" : json["status"].get<std::string>());
  if (json.contains("camera")) {
    const auto moved = [&](const char* key) { return json["camera"]["moved"][key].get<double>(); };
    text += std::format(
        "camera      turned by {:.2f} deg, moved by {:.0f} mm, {:+.1f} ms later than configured\n"
        "            LiDAR ranges {:+.2f} % shorter than it sees\n",
        moved("turn_deg"), 1e3 * moved("shift_m"), 1e3 * moved("delay_s"), 100.0 * moved("depth_stretch"));
  }
  if (json.contains("loops"))
    text += std::format("loops       {} closed, {} candidates refused\n", json["loops"]["accepted"].get<int>(),
                        json["loops"]["rejected"].get<int>());
  if (json.contains("ape"))
    text += std::format("APE         rmse {:.4f} m, median {:.4f} m, max {:.4f} m ({} poses)\n",
                        json["ape"]["rmse"].get<double>(), json["ape"]["median"].get<double>(),
                        json["ape"]["max"].get<double>(), json["matched"].get<int>());
  if (json.contains("rpe"))
    for (const Json& rpe : json["rpe"])
      if (rpe["rmse"].is_number())
        text += std::format("RPE {:>4} m  {:.4f} m = {:.2f} %, yaw {:.3f} deg\n", rpe["delta_m"].get<double>(),
                            rpe["rmse"].get<double>(), rpe["percent"].get<double>(), rpe["yaw_deg"].get<double>());
  if (json.contains("findings")) text += findings_text(json["findings"]);
  for (const Json& note : json["notes"]) text += "note        " + note.get<std::string>() + "\n";
  return text;
}

}  // namespace pllit::app
