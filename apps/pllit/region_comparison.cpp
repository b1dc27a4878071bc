#include "region_comparison.hpp"

#include <spdlog/spdlog.h>

#include <format>
#include <tuple>

#include "pllit/io/anomalies_file.hpp"
#include "pllit/io/regions_file.hpp"
#include "pllit/map/regions.hpp"
#include "pllit/slam/config_yaml.hpp"
#include "region_words.hpp"

namespace pllit::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Names of the recordings, without the folders that they were found in.
std::string recordings_of(const Json& sources) {
  std::string text;
  for (const Json& source : sources) {
    const auto name = source.get<std::string>();
    text += (text.empty() ? "" : " ") + (name.starts_with("sim:") ? name : fs::path(name).filename().string());
  }
  return text;
}

bool corrected_alike(const Radiometry& a, const Radiometry& b) {
  const auto numbers = [](const Radiometry& r) {
    return std::tie(r.emissivity, r.reflected_K, r.air_K, r.absorbed_per_m);
  };
  return numbers(a) == numbers(b);
}

}  // namespace

Expected<SessionFacts> session_facts(const Session& session) {
  const std::string folder = session.folder.string();
  const auto unit = read_unit(session.folder / "anomalies.json");
  if (!unit) return std::unexpected(unit.error());
  if (session.trajectory.empty() || !session.run || !session.run->contains("sources") ||
      !(*session.run)["sources"].is_array())
    return input_error(
        std::format("'{}': does not say when and from what recording it was made (trajectory.tum, "
                    "run.json); run it again",
                    folder));
  const Json& run = *session.run;
  const auto config = load_config(run.value("config", ""), (session.folder / "run.json").string());
  if (!config && *unit == IntensityUnit::kelvin) return std::unexpected(config.error());
  return SessionFacts{{.start = session.trajectory.front().time,
                       .recordings = recordings_of(run["sources"]),
                       .session = folder,
                       .program = run.value("program", "")},
                      *unit,
                      *unit == IntensityUnit::kelvin ? config->thermography.radiometry : Radiometry{}};
}

Expected<RegionComparison> RegionComparison::open(const fs::path& regions, const fs::path& store,
                                                  const Session& baseline, const PointTable& heat) {
  RegionComparison comparison;
  auto read = read_regions(regions);
  if (!read) return std::unexpected(read.error());
  auto facts = session_facts(baseline);
  if (!facts) return std::unexpected(facts.error());
  if (const auto checked = check_unit(*read, facts->unit, regions.string()); !checked)
    return std::unexpected(checked.error());
  comparison.file_ = regions;
  comparison.store_path_ = store;
  comparison.regions_ = std::move(*read);
  comparison.baseline_ = std::move(*facts);
  comparison.baseline_heat_ = heat;
  comparison.baseline_readings_ =
      baseline_readings(heat, comparison.regions_, {.baseline_radiometry = comparison.baseline_.radiometry});
  for (std::size_t i = 0; i < comparison.regions_.size(); ++i)
    if (comparison.baseline_readings_[i].voxels == 0)
      spdlog::warn("{}:{}: the baseline saw nothing in the box of '{}'; is the box in its map frame?", regions.string(),
                   comparison.regions_[i].line, comparison.regions_[i].tag);
  if (store.empty()) return comparison;
  auto opened =
      VisitStore::open_for(store, {comparison.baseline_.identity, digest_of(heat), comparison.baseline_.unit});
  if (!opened) return std::unexpected(opened.error());
  comparison.store_ = std::move(*opened);
  if (const auto done = comparison.record(comparison.baseline_.identity, comparison.baseline_readings_); !done)
    return std::unexpected(done.error());
  return comparison;
}

Expected<Json> RegionComparison::look(const Session& session, const PointTable& heat_W, const VisitDrift& drift) {
  const auto facts = session_facts(session);
  if (!facts) return std::unexpected(facts.error());
  if (!corrected_alike(facts->radiometry, baseline_.radiometry))
    spdlog::warn("'{}' was run with another advanced.radiometry than the baseline; run it again with the baseline's",
                 session.folder.string());
  const auto bring = [&](const Vector3d& p_W, double intensity) -> std::optional<double> {
    const auto brought = drift.bring(p_W, intensity);
    return brought ? std::optional(brought->value) : std::nullopt;
  };
  const auto readings =
      region_readings(baseline_heat_, heat_W, bring, regions_,
                      {.baseline_radiometry = baseline_.radiometry, .visit_radiometry = facts->radiometry});
  if (const auto done = record(facts->identity, readings); !done) return std::unexpected(done.error());
  Json json = Json::array();
  text_.clear();
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    json.push_back({{"tag", regions_[i].tag}});
    json.back().update(reading_json(readings[i]));
    text_ += std::format("  region {}: {}\n", regions_[i].tag, reading_text(readings[i], baseline_.unit));
    exceeded_ = exceeded_ || readings[i].exceeded();
  }
  return json;
}

Expected<void> RegionComparison::record(const VisitIdentity& visit, const std::vector<RegionReading>& readings) {
  if (!store_) return {};
  std::vector<NamedReading> named;
  for (std::size_t i = 0; i < regions_.size(); ++i)
    named.push_back({regions_[i].tag, definition_of(regions_[i]), readings[i]});
  return store_->record(visit, named);
}

Json RegionComparison::baseline_json() const {
  Json json{{"file", file_.string()},
            {"store", store_ ? Json(store_path_.string()) : Json()},
            {"unit", name_of(baseline_.unit)},
            {"baseline", Json::array()}};
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const auto limit = [](const std::optional<double>& given) { return given ? Json(*given) : Json(); };
    json["baseline"].push_back(
        {{"tag", regions_[i].tag},
         {"definition", definition_of(regions_[i])},
         {"limits", {{"change", limit(regions_[i].limits.change)}, {"kelvin", limit(regions_[i].limits.kelvin)}}}});
    json["baseline"].back().update(reading_json(baseline_readings_[i]));
  }
  return json;
}

}  // namespace pllit::app
