#include "session_heat.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "pllit/io/anomalies_file.hpp"
#include "pllit/io/file.hpp"
#include "pllit/report/report.hpp"
#include "pllit/report/severity_file.hpp"
#include "pllit/slam/frame_table.hpp"

namespace pllit::app {
namespace {

Expected<void> write_anomalies(SessionWriter& session, const std::vector<Anomaly>& anomalies, IntensityUnit unit) {
  return session.write_text("anomalies.json", anomalies_json(anomalies, unit).dump(2) + "\n");
}

void log_alarm(const Anomaly& anomaly) {
  const Vector3d& p_W = anomaly.position_W;
  spdlog::warn("alarm {}: {} at ({:.2f}, {:.2f}, {:.2f}) m, {:.1f} sigma above normal", anomaly.id,
               name_of(anomaly.kind), p_W.x(), p_W.y(), p_W.z(), anomaly.mean_sigmas);
}

Expected<SessionHeat> moved_heat(const SessionWriter& session, const Thermography& thermography,
                                 const LoopResult& loops) {
  SessionHeat heat{thermography, thermography.anomalies(), thermography.map().table(), thermography.anomaly_points()};
  if (!loops.closed()) return heat;
  const auto odometry = read_interrupted_tum(session.folder() / "odometry.tum");
  if (!odometry) return std::unexpected(odometry.error());
  const Time start = thermography.map().start().value_or(Time{});
  for (PointTable* table : {&heat.map, &heat.points}) move_points(*table, "seen_s", start, loops.correction, *odometry);
  for (Anomaly& anomaly : heat.anomalies)
    if (const auto T_O_I = pose_at(*odometry, anomaly.last_seen, std::chrono::seconds(1)))
      anomaly.position_W = loops.correction.T_M_O(anomaly.last_seen, *T_O_I).act(anomaly.position_W);
  return heat;
}

double number(const std::string& text) {
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// Rows that were not written whole are left out.
std::vector<HealthSample> frames_of(const CsvTable& health) {
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::ranges::find(health.columns, name) - health.columns.begin());
  };
  const std::size_t time = column("time_s"), state = column("state"), reasons = column("reasons"),
                    matched = column("inliers"), speed = column("speed_mps"), x = column("sigma_x_m"),
                    y = column("sigma_y_m"), z = column("sigma_z_m");
  std::vector<HealthSample> frames;
  for (const auto& row : health.rows) {
    if (std::max({time, state, reasons, matched, speed, x, y, z}) >= row.size()) continue;
    frames.push_back({.time_s = number(row[time]),
                      .state = row[state],
                      .reasons = row[reasons],
                      .sigma_m = std::hypot(number(row[x]), number(row[y]), number(row[z])),
                      .matched = number(row[matched]),
                      .speed_mps = number(row[speed])});
  }
  return frames;
}

/// Frames in a row that were in one state that is not good.
std::vector<DoubtfulStretch> doubts_of(const std::vector<HealthSample>& frames) {
  std::vector<DoubtfulStretch> doubts;
  bool open = false;
  for (const HealthSample& frame : frames) {
    if (open) doubts.back().to_s = frame.time_s;
    open = open && doubts.back().state == frame.state;
    if (open || frame.state == "good") continue;
    doubts.push_back({frame.time_s, frame.time_s, frame.state, frame.reasons});
    open = true;
  }
  return doubts;
}

}  // namespace

Expected<void> AlarmTeller::tell(SessionWriter& session, const Thermography& thermography, Time time) {
  bool changed = false;
  const std::vector<Anomaly> anomalies = thermography.anomalies();
  for (const Anomaly& anomaly : anomalies) {
    const auto [told, fresh] = told_.try_emplace(anomaly.id, anomaly.state);
    if (!fresh && told->second == anomaly.state) continue;
    told->second = anomaly.state;
    changed = changed || anomaly.confirmed.has_value();
    if (anomaly.confirmed == time) log_alarm(anomaly);
    if (!events_) continue;
    nlohmann::ordered_json event{{"event", "anomaly"}, {"time_s", to_seconds(time)}};
    event["anomaly"] = anomaly_json(anomaly);
    std::puts(event.dump().c_str());
    std::fflush(stdout);
  }
  return changed ? write_anomalies(session, anomalies, thermography.config().unit) : Expected<void>{};
}

Expected<SessionHeat> write_heat(SessionWriter& session, const Thermography& thermography, const LoopResult& loops) {
  auto heat = moved_heat(session, thermography, loops);
  if (!heat) return heat;
  auto done = write_anomalies(session, heat->anomalies, thermography.config().unit);
  if (done) done = session.write_cloud("thermal_map.ply", heat->map);
  if (done) done = session.write_cloud("anomalies.ply", heat->points);
  if (!done) return std::unexpected(done.error());
  return heat;
}

Expected<SeverityTable> severity_table(const Config& config) {
  const std::string& file = config.report.severity;
  if (file.empty()) return neta_100_18();
  const auto text = read_file(file);
  if (!text) return in_context("advanced.report.severity", text.error());
  auto table = parse_severity(*text, file);
  if (table && config.thermography.unit_choice != UnitChoice::kelvin)
    spdlog::warn("{} classes temperatures, but advanced.anomalies.unit is not kelvin, so nothing will be classed",
                 file);
  return table;
}

Expected<void> write_report(SessionWriter& session, const nlohmann::ordered_json& run, const SessionHeat* heat,
                            const SeverityTable& severity) {
  constexpr std::size_t kMapPoints = 500000;  // more a plan does not show
  auto whole = open_session(session.folder(), kMapPoints);
  if (!whole) return std::unexpected(whole.error());
  std::vector<HealthSample> frames = frames_of(whole->health);
  ReportContent content{.title = "Inspection " + whole->folder.filename().string(),
                        .trajectory = std::move(whole->trajectory),
                        .map = std::move(whole->map),
                        .doubts = doubts_of(frames),
                        .health = std::move(frames),
                        .severity = severity};
  if (heat) {
    const ThermographyConfig& config = heat->stage.config();
    content.has_images = heat->stage.map().size() > 0;
    content.unit = config.unit;
    content.counts_per_kelvin = config.counts_per_kelvin;
    content.radiometry = config.radiometry;
    content.voxel_m = config.map.voxel_m;
    content.known_after = config.map.model.learned_after;
    content.thermal_map = heat->map;
    content.anomalies = heat->anomalies;
    content.crops = heat->stage.crops();
  }
  return session.write_text("report.html", report_html(content, run));
}

}  // namespace pllit::app
