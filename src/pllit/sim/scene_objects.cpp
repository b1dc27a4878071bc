#include "pllit/sim/scene_objects.hpp"

#include <format>

#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

using Arrival = FindingSpec::Arrival;

FindingSpec named_finding(const SimConfig& config) {
  using Kind = FindingSpec::Kind;
  const bool heated = config.arrival == SimConfig::Arrival::drawn ? Random(config.seed, 42).uniform() < 0.5
                                                                  : config.arrival == SimConfig::Arrival::heated;
  return {.kind = config.finding == SimConfig::Finding::table     ? Kind::on_table
                  : config.finding == SimConfig::Finding::cabinet ? Kind::cabinet
                                                                  : Kind::pipe,
          .arrival = heated ? Arrival::heated_in_place : Arrival::brought_in_hot,
          .at_s = config.finding_at_s,
          .by_K = config.finding_K};
}

FindingSpec hot_box(Random& random) {
  constexpr double kFrom_s = 25.0, kTo_s = 50.0;
  const bool heated = random.uniform() < 0.5;
  return {.kind = FindingSpec::Kind::box,
          .arrival = heated ? Arrival::heated_in_place : Arrival::brought_in_hot,
          .at_s = random.uniform(kFrom_s, kTo_s),
          .by_K = random.uniform(5.0, 40.0),
          .size_m = random.uniform(0.1, 0.5),
          .farthest_m = random.uniform(2.0, 7.0)};
}

SceneObject object_of(const Actor& actor, const FindingSpec* finding, const std::vector<Vector3d>& path_W) {
  const double begins = begins_s(actor);
  SceneObject object{.name = actor.name, .finding = actor.finding, .arrival = "there", .begins_s = begins};
  if (begins > 0.0) object.arrival = actor.heating.empty() ? "brought" : "heated";
  if (finding) object.by_K = finding->by_K;
  if (finding && finding->kind == FindingSpec::Kind::box) object.size_m = finding->size_m;
  object.centroid_W = visible_centroid_W(actor, begins, path_W);
  return object;
}

}  // namespace

std::vector<FindingSpec> findings_of(const SimConfig& config) {
  std::vector<FindingSpec> findings;
  if (config.finding != SimConfig::Finding::none) findings.push_back(named_finding(config));
  Random random(config.seed, 43);
  for (int i = 0; i < config.hot_boxes; ++i) findings.push_back(hot_box(random));
  return findings;
}

std::vector<DistractorSpec> distractors_of(const SimConfig& config) {
  if (config.finding == SimConfig::Finding::none) return {};
  return {{.kind = DistractorSpec::Kind::cold_object, .at_s = config.finding_at_s},
          {.kind = DistractorSpec::Kind::hot_radiator, .at_s = 0.0}};
}

std::vector<SceneObject> objects_of(const Place& place, std::span<const FindingSpec> findings,
                                    std::span<const Sighting> sightings, const std::vector<Vector3d>& path_W) {
  std::vector<SceneObject> objects;
  std::size_t next = 0;  // finding
  int boxes = 0;
  for (std::size_t i = 0; i < place.actors().size(); ++i) {
    const Actor& actor = place.actors()[i];
    if (actor.path.size() > 1) continue;  // people and cars go their own way
    const FindingSpec* finding = actor.finding ? &findings[next++] : nullptr;
    SceneObject object = object_of(actor, finding, path_W);
    if (object.size_m) object.name = std::format("box {}", ++boxes);
    object.first_seen_s = sightings[i].first_s;
    object.nearest_m = sightings[i].nearest_m;
    if (const auto centroid_O = sightings[i].centroid_O())
      object.centroid_W = actor.path.front().T_W_O.act(*centroid_O);
    objects.push_back(std::move(object));
  }
  return objects;
}

}  // namespace pllit
