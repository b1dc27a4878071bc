// pllit compare: what has changed since an earlier visit.
#include <spdlog/spdlog.h>
#include <algorithm>
#include <cstdio>
#include <format>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "pllit/geometry/lie_json.hpp"
#include "pllit/io/anomalies_file.hpp"
#include "pllit/io/ply.hpp"
#include "pllit/io/session.hpp"
#include "pllit/map/visit_changes.hpp"
#include "pllit/slam/config_yaml.hpp"
#include "pllit/slam/relocalisation.hpp"
#include "program.hpp"
#include "region_comparison.hpp"

namespace pllit::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct CompareOptions {
  std::string baseline;
  std::vector<std::string> sessions;
  std::optional<std::string> regions;
  std::string store;
  bool json = false, alarm_exit = false;
};

struct Visit {
  Session session;  ///< without its map's points, which stand below
  ThermographyConfig thermography;
  VisitMap map;
  VisitHeat seen;
};

/// What the run was told; nothing where it was killed before it wrote that down.
std::optional<Config> config_of(const Session& session) {
  if (!session.run || session.odometry.empty()) return std::nullopt;
  const auto config = load_config(session.run->value("config", ""), "run.json");
  return config ? std::optional(*config) : std::nullopt;
}

/// What the visit's images were: its own configuration, or where that is lost what its findings are in.
ThermographyConfig thermography_of(const std::optional<Config>& config, const fs::path& folder) {
  const ThermographyConfig thermography = config ? config->thermography : open_thresholds();
  return by_unit(thermography, read_unit(folder / "anomalies.json").value_or(unit_of(thermography, true)));
}

/// Points of the map, each with the place that the LiDAR measured it from.
std::vector<Sightline> sightlines_of(const Session& session, const std::optional<SE3>& T_I_L) {
  const auto* times_s = find_field(session.map, "time");
  std::vector<Sightline> lines_W;
  for (std::size_t i = 0; i < session.map.points.size(); ++i) {
    Sightline line{session.map.points[i], session.map.points[i]};
    if (T_I_L && times_s) {
      const Time time = session.odometry.front().time + from_seconds(static_cast<double>((*times_s)[i]));
      if (const auto T_W_I = pose_at(session.trajectory, time, std::chrono::seconds(1)))
        line.from_W = (*T_W_I * *T_I_L).translation().cast<float>();
    }
    lines_W.push_back(line);
  }
  return lines_W;
}

Expected<Visit> read_visit(const fs::path& folder) {
  auto session = open_session(folder);
  if (!session) return std::unexpected(session.error());
  if (!fs::exists(folder / "thermal_map.ply"))
    return input_error(std::format("'{}' holds no thermal_map.ply: that run saw no images", folder.string()));
  auto heat = read_ply(folder / "thermal_map.ply");
  if (!heat) return std::unexpected(heat.error());
  const auto config = config_of(*session);
  const auto T_I_L = config ? std::optional(make_rig(config->rig).T_I_L) : std::nullopt;
  auto sightlines_W = sightlines_of(*session, T_I_L);
  if (!T_I_L)
    spdlog::warn("'{}' does not say where its LiDAR was on the rig: what is new or gone cannot be told by it",
                 folder.string());
  VisitMap map{session->trajectory, std::move(session->map.points)};
  return Visit{std::move(*session),
               thermography_of(config, folder),
               std::move(map),
               {std::move(*heat), std::move(sightlines_W)}};
}

void move(VisitHeat& seen, const SE3& T_A_B) {
  const auto move_point = [&](Vector3f& p) { p = T_A_B.act(p.cast<double>()).cast<float>(); };
  std::ranges::for_each(seen.heat.points, move_point);
  for (Sightline& line : seen.sightlines_W) {
    move_point(line.from_W);
    move_point(line.to_W);
  }
}

Json change_json(const VisitChange& change) {
  return {{"kind", name_of(change.kind)},
          {"position_m", vector_json(change.position_W)},
          {"extent_m", vector_json(change.extent_m)},
          {"voxels", change.voxels},
          {"change", {{"mean", change.mean}, {"peak", change.peak}}},
          {"change_sigmas", {{"mean", change.mean_sigmas}}}};
}

/// One visit against the baseline; with named regions also what it shows of them.
Expected<Json> compared(const Visit& baseline, const std::string& baseline_folder, const std::string& folder,
                        std::optional<RegionComparison>& regions) {
  auto visit = read_visit(folder);
  if (!visit) return std::unexpected(visit.error());
  if (visit->thermography.unit != baseline.thermography.unit)
    return input_error(
        std::format("'{}' is in {}, but the baseline '{}' in {}: run one of them again in the other's unit", folder,
                    name_of(visit->thermography.unit), baseline_folder, name_of(baseline.thermography.unit)));
  const auto located = relocalise(baseline.map, visit->map);
  if (!located) return in_context(std::format("comparing '{}'", folder), located.error());
  move(visit->seen, located->T_A_B);
  const VisitChanges found = changes_between(baseline.seen, visit->seen, visit_changes_config(baseline.thermography));
  if (!found.same_site)
    return input_error(std::format(
        "comparing '{}': where it fits onto '{}' only {:.0f} % of its surfaces lie on surfaces measured there; "
        "are they of the same site?",
        folder, baseline_folder, 100.0 * found.surfaces_shared));
  Json json{{"session", folder},
            {"T_baseline_session", pose_json(located->T_A_B)},
            {"relocalisation",
             {{"places", located->places},
              {"agreeing", located->agreeing},
              {"overlap", located->overlap},
              {"rmse_m", located->rmse_m}}},
            {"surfaces_shared", found.surfaces_shared},
            {"voxels", {{"shared", found.shared}, {"not_seen_again", found.only_before}, {"only_now", found.only_now}}},
            {"drift",
             {{"holds", found.drift.covered() > 0.0},
              {"covered", found.drift.covered()},
              {"gain", found.drift.whole().curve.gain},
              {"bias", found.drift.whole().curve.bias},
              {"rms", found.drift.whole().rms}}},
            {"unit", name_of(baseline.thermography.unit)},
            {"changes", Json::array()}};
  for (const VisitChange& change : found.changes) json["changes"].push_back(change_json(change));
  if (!regions) return json;
  auto looked = regions->look(visit->session, visit->seen.heat, found.drift);
  if (!looked) return std::unexpected(looked.error());
  json["regions"] = std::move(*looked);
  return json;
}

std::string visit_text(const Json& visit) {
  const int shared = visit["voxels"]["shared"], missed = visit["voxels"]["not_seen_again"];
  std::string text =
      std::format("{}\n  found its place: {} of {} places agree, {:.0f} % of its surfaces are on the baseline's\n",
                  visit["session"].get<std::string>(), visit["relocalisation"]["agreeing"].get<int>(),
                  visit["relocalisation"]["places"].get<int>(), 100.0 * visit["surfaces_shared"].get<double>());
  text += std::format("  images showed again: {:.0f} % of what the baseline's did ({} voxels)\n",
                      100.0 * shared / std::max(1, shared + missed), shared);
  if (!visit["drift"]["holds"].get<bool>())
    return text + "  the visits' intensities fit to each other by no curve: nothing is said about changes\n";
  if (const double covered = visit["drift"]["covered"]; covered < 0.95)
    text += std::format("  judged: {:.0f} % of those; the others' intensities fit to each other by no curve\n",
                        100.0 * covered);
  for (const Json& change : visit["changes"]) {
    const auto p = change["position_m"].get<std::array<double, 3>>();
    if (change["kind"] == "gone") {
      text += std::format("  gone     at ({:.2f}, {:.2f}, {:.2f}) m: {} voxels\n", p[0], p[1], p[2],
                          change["voxels"].get<int>());
      continue;
    }
    text += std::format(
        "  {:8} at ({:.2f}, {:.2f}, {:.2f}) m: {:+.1f} {} on average, {:+.1f} at most, {:.1f} sigma, {} voxels\n",
        change["kind"].get<std::string>(), p[0], p[1], p[2], change["change"]["mean"].get<double>(),
        visit["unit"].get<std::string>(), change["change"]["peak"].get<double>(),
        change["change_sigmas"]["mean"].get<double>(), change["voxels"].get<int>());
  }
  return text + (visit["changes"].empty() ? "  nothing has changed\n" : "");
}

Expected<ExitCode> compare(const CompareOptions& options) {
  const auto baseline = read_visit(options.baseline);
  if (!baseline) return std::unexpected(baseline.error());
  std::optional<RegionComparison> regions;
  if (options.regions) {
    auto opened = RegionComparison::open(*options.regions, options.store, baseline->session, baseline->seen.heat);
    if (!opened) return std::unexpected(opened.error());
    regions.emplace(std::move(*opened));
  }
  Json json{{"schema_version", kSchemaVersion}, {"baseline", options.baseline}};
  if (regions) json["regions"] = regions->baseline_json();
  json["sessions"] = Json::array();
  std::string text;
  for (const std::string& folder : options.sessions) {
    const auto visit = compared(*baseline, options.baseline, folder, regions);
    if (!visit) return std::unexpected(visit.error());
    text += visit_text(*visit) + (regions ? regions->text() : "");
    json["sessions"].push_back(*visit);
  }
  std::fputs((options.json ? json.dump(2) + "\n" : text).c_str(), stdout);
  return options.alarm_exit && regions && regions->exceeded() ? ExitCode::alarm : ExitCode::done;
}

ExitCode run(const CompareOptions& options) {
  const auto code = compare(options);
  return code ? *code : report(code.error());
}

}  // namespace

Verb add_compare(CLI::App& program) {
  CLI::App* verb =
      program.add_subcommand("compare", "Find a visit's place in an earlier one, and what has changed since");
  const auto options = std::make_shared<CompareOptions>();
  verb->add_option("baseline", options->baseline, "Session of the earlier visit")->type_name("BASELINE")->required();
  verb->add_option("session", options->sessions, "Sessions of later visits")->type_name("SESSION...")->required();
  CLI::Option* regions =
      verb->add_option("--regions", options->regions, "Named regions of the baseline's map to look up on each visit")
          ->type_name("FILE.yaml");
  verb->add_option("--store", options->store, "Keep what is seen of them, for pllit trends")
      ->type_name("FILE.sqlite")
      ->needs(regions);
  verb->add_flag("--json", options->json, "Print the comparison as JSON");
  verb->add_flag("--alarm-exit", options->alarm_exit, "Exit with 4 where a region exceeds a limit")->needs(regions);
  verb->footer(
      "Examples:\n"
      "  pllit compare results/monday results/friday\n"
      "  pllit compare results/monday results/tuesday results/friday --json\n"
      "  pllit compare results/monday results/friday --regions hall.yaml --store hall.sqlite");
  return {verb, [options] { return run(*options); }};
}

}  // namespace pllit::app
