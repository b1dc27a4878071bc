// pllit trends: how named regions went on from visit to visit.
#include <algorithm>
#include <cstdio>
#include <format>
#include <memory>
#include <nlohmann/json.hpp>

#include "pllit/base/words.hpp"
#include "pllit/io/visit_store.hpp"
#include "pllit/map/regions.hpp"
#include "program.hpp"
#include "region_words.hpp"

namespace pllit::app {
namespace {

using Json = nlohmann::ordered_json;

struct TrendsOptions {
  std::string store, tag;
  bool json = false;
};

/// Over the visits whose region was the last one's: of its change voxel by voxel, which does not mind that a visit saw
/// less of it, and of its 95th percentile.
struct Trends {
  std::optional<RegionTrend> change, p95;
};

Trends trends_of(const RegionSeries& series) {
  std::vector<TimedValue> changes, p95s;
  for (const auto& [visit, definition, reading] : series.points) {
    if (definition != series.points.back().definition) continue;
    if (reading.change) changes.push_back({visit.start, reading.change->mean});
    if (reading.brought) p95s.push_back({visit.start, reading.brought->p95});
  }
  return {trend_of(changes), trend_of(p95s)};
}

Json trend_json(const std::optional<RegionTrend>& trend) {
  if (!trend) return {};
  return {{"per_day", trend->per_day}, {"visits", trend->visits}, {"days", trend->days}};
}

std::string trend_text(std::string_view name, const std::optional<RegionTrend>& trend, IntensityUnit unit) {
  if (!trend) return std::format("  no trend of its {} yet: it takes three visits over an hour\n", name);
  return std::format("  trend of its {}: {:+.2f} {} a day, over {} visits in {:.1f} days\n", name, trend->per_day,
                     name_of(unit), trend->visits, trend->days);
}

/// The wanted region only, or all where no tag is given.
Expected<std::vector<RegionSeries>> chosen(std::vector<RegionSeries> all, const TrendsOptions& options) {
  if (options.tag.empty()) return all;
  std::vector<std::string> tags;
  for (RegionSeries& series : all) {
    if (series.tag == options.tag) return std::vector{std::move(series)};
    tags.push_back(series.tag);
  }
  return input_error(std::format("{}: holds no region '{}'; did you mean '{}'?", options.store, options.tag,
                                 nearest_word(options.tag, tags)));
}

Json series_json(const RegionSeries& series) {
  Json json{{"tag", series.tag}, {"definition", series.points.back().definition}, {"visits", Json::array()}};
  for (const auto& [visit, definition, reading] : series.points) {
    Json point{{"time_s", to_seconds(visit.start)},
               {"time_utc", utc_of(visit.start)},
               {"session", visit.session},
               {"program", visit.program},
               {"definition", definition}};
    point.update(reading_json(reading));
    json["visits"].push_back(std::move(point));
  }
  const Trends trends = trends_of(series);
  json["trend"] = {{"change", trend_json(trends.change)}, {"p95", trend_json(trends.p95)}};
  return json;
}

std::string series_text(const RegionSeries& series, IntensityUnit unit) {
  const std::string& definition_now = series.points.back().definition;
  std::string text = std::format("{}: {}\n", series.tag, definition_now);
  for (const auto& [visit, definition, reading] : series.points)
    text += std::format("  {}  {}{}\n", utc_of(visit.start), reading_text(reading, unit),
                        definition == definition_now ? "" : "; of another box: " + definition);
  const Trends trends = trends_of(series);
  return text + trend_text("change", trends.change, unit) + trend_text("95th percentile", trends.p95, unit);
}

Expected<std::string> trends(const TrendsOptions& options) {
  auto store = VisitStore::open(options.store);
  if (!store) return std::unexpected(store.error());
  auto all = store->series();
  if (!all) return std::unexpected(all.error());
  const auto wanted = chosen(std::move(*all), options);
  if (!wanted) return std::unexpected(wanted.error());
  const auto& [baseline, digest, unit] = store->baseline();
  Json json{{"schema_version", kSchemaVersion},
            {"store", options.store},
            {"unit", name_of(unit)},
            {"baseline", {{"session", baseline.session}, {"time_utc", utc_of(baseline.start)}}},
            {"regions", Json::array()}};
  std::string text =
      std::format("changes are against the baseline {} of {}\n", baseline.session, utc_of(baseline.start));
  for (const RegionSeries& series : *wanted) {
    json["regions"].push_back(series_json(series));
    text += series_text(series, unit);
  }
  return options.json ? json.dump(2) + "\n" : text;
}

ExitCode run(const TrendsOptions& options) {
  const auto text = trends(options);
  if (!text) return report(text.error());
  std::fputs(text->c_str(), stdout);
  return ExitCode::done;
}

}  // namespace

Verb add_trends(CLI::App& program) {
  CLI::App* verb = program.add_subcommand("trends", "Show how named regions went on from visit to visit");
  const auto options = std::make_shared<TrendsOptions>();
  verb->add_option("store", options->store, "What pllit compare --store wrote")->type_name("STORE")->required();
  verb->add_option("--tag", options->tag, "Only the region of that name")->type_name("TAG");
  verb->add_flag("--json", options->json, "Print the series as JSON");
  verb->footer(
      "Examples:\n"
      "  pllit trends hall.sqlite\n"
      "  pllit trends hall.sqlite --tag pump-3 --json");
  return {verb, [options] { return run(*options); }};
}

}  // namespace pllit::app
