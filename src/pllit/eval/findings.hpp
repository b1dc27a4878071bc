// Reported anomalies against what there was to find.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/eval/statistics.hpp"
#include "pllit/state/anomaly.hpp"

namespace pllit {

/// Something that was put into a place; what is no finding must not be reported.
struct TrueObject {
  std::string name;
  bool finding = false;
  Time begins{};                           ///< when it became hot, or was brought
  Vector3d centroid_W = Vector3d::Zero();  ///< of its surface that the camera saw
  std::optional<Time> first_seen{};        ///< first image after that which showed it; nothing: never seen
};

/// The objects of F.scene.json (docs/SIMULATOR.md). Input errors say what is missing.
Expected<std::vector<TrueObject>> objects_of_scene(const nlohmann::ordered_json& scene);

/// What became of one finding that was to be seen.
struct ObjectScore {
  std::string name;
  bool found = false;
  double position_m = 0.0, delay_s = 0.0;  ///< where it was found
};

struct FindingScores {
  int objects = 0;                 ///< findings that were to be seen
  int found = 0;                   ///< of those, with an alarm near enough after they began
  int false_alarms = 0;            ///< alarms that belong to none
  int duplicates = 0;              ///< further alarms of the same object
  std::vector<double> position_m;  ///< of the found ones, from alarm to centroid
  std::vector<double> delay_s;     ///< of the found ones, from first sight to alarm
  std::vector<ObjectScore> each;   ///< in the scene's order
};

/// An alarm is an anomaly that was confirmed, whatever became of it. It belongs to the nearest finding within
/// `reach_m`; of several the largest counts for the position, the first for the delay. T_W_V: world of the estimate to
/// world of the truth.
FindingScores score_findings(std::span<const Anomaly> anomalies, std::span<const TrueObject> objects, const SE3& T_W_V,
                             double reach_m = 0.5);

/// {"objects", "found", "false_alarms", "duplicates", "position_m": {"median", "max"}, "delay_s": {"max"}, "each":
/// [{"name", "found", "position_m", "delay_s"}]}; null where nothing was found. Keys may be added, never changed.
nlohmann::ordered_json findings_json(const FindingScores& scores);

}  // namespace pllit
