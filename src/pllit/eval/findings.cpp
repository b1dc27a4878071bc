#include "pllit/eval/findings.hpp"

#include <algorithm>
#include <array>
#include <format>
#include <nlohmann/json.hpp>

namespace pllit {
namespace {

using Json = nlohmann::ordered_json;

TrueObject object_of(const Json& json, double start_s) {
  const auto time = [start_s](const Json& seconds) { return Time(from_seconds(start_s + seconds.get<double>())); };
  TrueObject object{.name = json.at("name"), .finding = json.at("finding"), .begins = time(json.at("begins_s"))};
  const auto centroid = json.at("centroid_W").get<std::array<double, 3>>();
  object.centroid_W = {centroid[0], centroid[1], centroid[2]};
  if (!json.at("first_seen_s").is_null()) object.first_seen = time(json.at("first_seen_s"));
  return object;
}

/// The finding that an alarm belongs to.
const TrueObject* nearest_finding(const Anomaly& anomaly, std::span<const TrueObject> objects, const SE3& T_W_V,
                                  double reach_m) {
  const TrueObject* nearest = nullptr;
  double least_m = reach_m;
  for (const TrueObject& object : objects) {
    if (!object.finding || *anomaly.confirmed < object.begins) continue;
    const double distance_m = (T_W_V.act(anomaly.position_W) - object.centroid_W).norm();
    if (distance_m > least_m) continue;
    nearest = &object;
    least_m = distance_m;
  }
  return nearest;
}

}  // namespace

Expected<std::vector<TrueObject>> objects_of_scene(const Json& scene) try {
  std::vector<TrueObject> objects;
  for (const Json& object : scene.at("objects")) objects.push_back(object_of(object, scene.at("start_s")));
  return objects;
} catch (const Json::exception& error) {
  return input_error(std::format("no scene as the simulator writes it: {}", error.what()));
}

FindingScores score_findings(std::span<const Anomaly> anomalies, std::span<const TrueObject> objects, const SE3& T_W_V,
                             double reach_m) {
  FindingScores scores;
  std::vector<std::pair<const TrueObject*, const Anomaly*>> alarms;
  for (const Anomaly& anomaly : anomalies) {
    if (!anomaly.confirmed) continue;
    if (const TrueObject* object = nearest_finding(anomaly, objects, T_W_V, reach_m))
      alarms.emplace_back(object, &anomaly);
    else
      ++scores.false_alarms;
  }
  for (const TrueObject& object : objects) {
    if (!object.finding || !object.first_seen) continue;
    ++scores.objects;
    const Anomaly* largest = nullptr;
    std::optional<Time> first;
    int count = 0;
    for (const auto& [finding, anomaly] : alarms) {
      if (finding != &object) continue;
      ++count;
      if (!largest || anomaly->voxels > largest->voxels) largest = anomaly;
      first = std::min(first.value_or(*anomaly->confirmed), *anomaly->confirmed);
    }
    scores.each.push_back({.name = object.name, .found = largest != nullptr});
    if (!largest) continue;
    ++scores.found;
    scores.duplicates += count - 1;
    ObjectScore& score = scores.each.back();
    score.position_m = (T_W_V.act(largest->position_W) - object.centroid_W).norm();
    score.delay_s = to_seconds(*first - *object.first_seen);
    scores.position_m.push_back(score.position_m);
    scores.delay_s.push_back(score.delay_s);
  }
  return scores;
}

Json findings_json(const FindingScores& scores) {
  const auto figure = [&](double value) { return scores.found > 0 ? Json(value) : Json(nullptr); };
  const Statistics position = statistics_of(scores.position_m);
  const double delay_s = scores.found > 0 ? *std::ranges::max_element(scores.delay_s) : 0.0;
  Json each = Json::array();
  for (const ObjectScore& score : scores.each)
    each.push_back({{"name", score.name},
                    {"found", score.found},
                    {"position_m", score.found ? Json(score.position_m) : Json(nullptr)},
                    {"delay_s", score.found ? Json(score.delay_s) : Json(nullptr)}});
  return {{"objects", scores.objects},
          {"found", scores.found},
          {"false_alarms", scores.false_alarms},
          {"duplicates", scores.duplicates},
          {"position_m", {{"median", figure(position.median)}, {"max", figure(position.max)}}},
          {"delay_s", {{"max", figure(delay_s)}}},
          {"each", std::move(each)}};
}

}  // namespace pllit
