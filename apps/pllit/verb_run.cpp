// pllit run: a recording or a simulation becomes a session: trajectory, map and health record.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <stop_token>
#include <utility>

#include "findings.hpp"
#include "interrupt.hpp"
#include "pllit/eval/evaluate.hpp"
#include "pllit/eval/scores_json.hpp"
#include "pllit/io/file.hpp"
#include "pllit/io/session.hpp"
#include "pllit/io/tum.hpp"
#include "pllit/slam/config_yaml.hpp"
#include "pllit/slam/frame_table.hpp"
#include "pllit/slam/run.hpp"
#include "program.hpp"
#include "progress_bar.hpp"
#include "session_heat.hpp"
#include "session_loops.hpp"
#include "source.hpp"
#include "summary.hpp"

namespace pllit::app {
namespace {

namespace fs = std::filesystem;

struct RunOptions {
  std::vector<std::string> sources, settings;
  std::string config, out, truth;
  bool json = false, events = false, alarm_exit = false;
};

/// Hands frames to the session: poses and health as they come, points that are new to the map, alarms.
FrameSink session_sink(SessionWriter& session, MapRecorder& map, const std::optional<Thermography>& thermography,
                       AlarmTeller& alarms) {
  return [&](const FrameEstimate& frame) -> Expected<void> {
    const NavState& state = frame.posterior.mean;
    if (auto done = session.append_pose({state.time, state.T_W_I()}); !done) return done;
    if (auto done = session.append_health(health_row(frame)); !done) return done;
    if (thermography && frame.image)
      if (auto done = alarms.tell(session, *thermography, state.time); !done) return done;
    return session.append_map(map.new_points(frame));
  };
}

/// The same frames to loop closing as well.
FrameSink with_loops(FrameSink sink, LoopStage& loops) {
  return [sink = std::move(sink), &loops](const FrameEstimate& frame) -> Expected<void> {
    loops.take(frame);
    return sink(frame);
  };
}

nlohmann::ordered_json run_json(const RunSummary& summary, const Rig& rig, const RunOptions& options,
                                const Config& config, const char* status) {
  nlohmann::ordered_json json = summary_json(summary);
  if (summary.mount) json["camera"] = camera_json(*summary.mount, rig);
  json["status"] = status;
  json["program"] = version_line();
  json["sources"] = options.sources;
  json["config"] = dump_config(config);
  return json;
}

/// Scores the session's trajectory where the truth is known, into the summary.
Expected<void> add_scores(nlohmann::ordered_json& json, const Trajectory& truth, const fs::path& session) {
  if (truth.empty()) return {};
  const auto estimate = read_tum(session / "trajectory.tum");
  if (!estimate) return std::unexpected(estimate.error());
  const auto scores = evaluate(truth, *estimate);
  if (!scores) return in_context("scoring against the truth", scores.error());
  const nlohmann::ordered_json figures = scores_json(*scores);
  for (const char* key : {"ape", "rpe", "matched", "align"}) json[key] = figures[key];
  return {};
}

Expected<Trajectory> truth_of(const RunOptions& options, const OpenedSource& source) {
  if (options.truth.empty()) return source.truth;
  return read_tum(options.truth);
}

class SessionRun {
 public:
  SessionRun(const RunOptions& options, const Config& config, SeverityTable severity, OpenedSource source,
             Trajectory truth, SessionWriter session, std::stop_token stop)
      : options_(options),
        config_(config),
        severity_(std::move(severity)),
        source_(std::move(source)),
        truth_(std::move(truth)),
        session_(std::move(session)),
        stop_(std::move(stop)),
        map_(config.map_file_voxel_m, config.map.radius_m),
        alarms_(options.events) {
    if (source_.rig.camera && source_.sees_heat && config.vision.enabled)
      thermography_.emplace(*source_.rig.camera, config.thermography);
    if (!thermography_ && (options.events || options.alarm_exit))
      spdlog::warn(
          "there will be no alarms: no images of heat are evaluated (no camera, a visible one, or "
          "thermal.enabled=false)");
    if (config.loop.enabled) loop_stage_.emplace(config.loop);
  }

  Expected<ExitCode> operator()() {
    if (!source_.truth.empty())
      if (auto done = write_tum(session_.folder() / "truth.tum", source_.truth); !done)
        return std::unexpected(done.error());
    RunSummary summary;
    // What a kill leaves behind says of itself that it is unfinished.
    if (auto done = session_.write_run(run_json(summary, source_.rig, options_, config_, "unfinished")); !done)
      return std::unexpected(done.error());
    auto result = run(summary);
    if (const auto closed = close_loops(summary); result && !closed) result = closed;
    return finish(summary, result);
  }

 private:
  Expected<void> run(RunSummary& summary) {
    ProgressBar bar("frames", spdlog::should_log(spdlog::level::info));
    const FrameSink sink = session_sink(session_, map_, thermography_, alarms_);
    const RunHooks hooks{.sink = loop_stage_ ? with_loops(sink, *loop_stage_) : sink,
                         .progress = [&](double share) { bar.show(share, summary.frames); },
                         .stop = stop_,
                         .thermography = thermography_ ? &*thermography_ : nullptr};
    return run_odometry(*source_.events, source_.rig, config_, hooks, summary);
  }

  /// However the run ended: what was seen until then closes too.
  Expected<void> close_loops(RunSummary& summary) {
    if (!loop_stage_) return {};
    loops_ = loop_stage_->finish();
    summary.stage_ms[static_cast<std::size_t>(Stage::loop)] = loops_.frame_ms;
    if (!loops_.stopped.empty()) summary.notes.push_back("loop closing stopped: " + loops_.stopped);
    return write_loops(session_, loops_);
  }

  Expected<void> close_heat() {
    if (!thermography_) return {};
    auto written = write_heat(session_, *thermography_, loops_);
    if (!written) return std::unexpected(written.error());
    heat_.emplace(std::move(*written));
    return {};
  }

  Expected<ExitCode> finish(const RunSummary& summary, const Expected<void>& result) {
    const char* status = !result ? "failed" : summary.interrupted ? "interrupted" : "done";
    auto json = run_json(summary, source_.rig, options_, config_, status);
    if (!result) json["error"] = result.error().message;
    json["loops"] = {{"accepted", loops_.accepted},
                     {"rejected", loops_.records.size() - static_cast<std::size_t>(loops_.accepted)}};
    const auto scene = source_.scene_json ? write_file(session_.folder() / "scene.json", source_.scene_json() + "\n")
                                          : Expected<void>{};
    const auto heat = close_heat();
    auto scored = summary.frames > 1 ? add_scores(json, truth_, session_.folder()) : Expected<void>{};
    if (scored && heat && heat_ && source_.scene_json && summary.frames > 1) scored = add_findings(json);
    if (!scored) json["notes"].push_back(scored.error().message);
    const auto written = session_.write_run(json);
    const auto reported = heat ? write_report(session_, json, heat_ ? &*heat_ : nullptr, severity_) : heat;
    print(json);
    // What stopped the run comes first: a full disk hits these files too.
    for (const auto* done : {&result, &written, &scene, &heat, &reported})
      if (!*done) return report(done->error());
    if (summary.interrupted) {
      spdlog::warn("interrupted; what was done is in {}", session_.folder().string());
      return ExitCode::failed;
    }
    if (!scored && !options_.truth.empty()) return report(scored.error());
    if (options_.alarm_exit && alarmed()) return ExitCode::alarm;
    return summary.was_degraded() ? ExitCode::degraded : ExitCode::done;
  }

  /// Whether anything is, or was, abnormally hot.
  bool alarmed() const {
    return thermography_ && std::ranges::any_of(thermography_->anomalies(),
                                                [](const Anomaly& anomaly) { return anomaly.confirmed.has_value(); });
  }

  /// Scores the anomalies against what the simulator put there.
  Expected<void> add_findings(nlohmann::ordered_json& json) {
    const auto scores = score_session_findings(session_.folder() / "scene.json", session_.folder(), Alignment::se3);
    if (!scores) return in_context("scoring the findings", scores.error());
    json["findings"] = findings_json(*scores);
    return {};
  }

  void print(nlohmann::ordered_json json) const {
    const std::string folder = session_.folder().string();
    json.erase("config");
    json["session"] = folder;
    std::fputs((options_.json ? json.dump(2) + "\n" : summary_text(json) + "session     " + folder + "\n").c_str(),
               stdout);
  }

  const RunOptions& options_;
  const Config& config_;
  SeverityTable severity_;
  OpenedSource source_;
  Trajectory truth_;
  SessionWriter session_;
  std::stop_token stop_;
  MapRecorder map_;
  AlarmTeller alarms_;
  std::optional<Thermography> thermography_;  // none without a camera that sees heat
  std::optional<LoopStage> loop_stage_;       // none where loop closing is off
  LoopResult loops_;
  std::optional<SessionHeat> heat_;  // once written
};

Expected<ExitCode> run_session(const RunOptions& options) {
  const auto config = read_config(options.config, options.settings);
  if (!config) return std::unexpected(config.error());
  auto severity = severity_table(*config);
  if (!severity) return std::unexpected(severity.error());
  const Interrupt interrupt;  // before a source starts threads
  auto source = open_source(options.sources, *config, config->vision.enabled ? Images::wanted : Images::skipped);
  if (!source) return std::unexpected(source.error());
  auto truth = truth_of(options, *source);
  if (!truth) return std::unexpected(truth.error());
  const fs::path folder = options.out.empty()
                              ? default_session_folder("results", source->name, std::chrono::system_clock::now())
                              : fs::path(options.out);
  auto session =
      SessionWriter::create(folder, {.health_columns = health_columns(), .map_fields = MapRecorder::fields()});
  if (!session) return std::unexpected(session.error());
  if (options.out.empty())
    if (const auto linked = link_latest(folder); !linked) spdlog::warn("{}", linked.error().message);
  return SessionRun(options, *config, std::move(*severity), std::move(*source), std::move(*truth), std::move(*session),
                    interrupt.token())();
}

ExitCode run(const RunOptions& options) {
  const auto code = run_session(options);
  return code ? *code : report(code.error());
}

}  // namespace

Verb add_run(CLI::App& program) {
  CLI::App* verb = program.add_subcommand("run", "Estimate trajectory and map from a recording or a simulation");
  const auto options = std::make_shared<RunOptions>();
  verb->add_option("source", options->sources, "ROS 1 bags of one recording, or sim:SCENE?key=value&...")
      ->type_name("SOURCE...")
      ->required();
  verb->add_option("--config", options->config, "Preset or YAML file (default: the defaults)")
      ->type_name("FILE|PRESET");
  verb->add_option("--out", options->out, "Session folder (default: results/NAME-TIME)")->type_name("DIR");
  verb->add_option("--truth", options->truth, "True trajectory to score against")->type_name("FILE.tum");
  verb->add_option("--set", options->settings, "Replace one value of the configuration, e.g. map.voxel_m=0.3")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1);
  verb->add_flag("--json", options->json, "Print the summary as JSON");
  verb->add_flag("--events", options->events, "Print a line of JSON whenever an anomaly appears or changes its state");
  verb->add_flag("--alarm-exit", options->alarm_exit, "Exit with 4 where an alarm was raised");
  verb->footer(
      "Examples:\n"
      "  pllit run 'sim:box_room?seed=1&duration=30'\n"
      "  pllit run drive.bag --config kitti --truth drive.tum --out results/drive");
  return {verb, [options] { return run(*options); }};
}

}  // namespace pllit::app
