// Loop closing on a simulated drive, scored against the truth:
//   bench_loops ADDRESS PRESET [--motion F.tum] [--drift DEG_PER_MIN] [--keep FILE] [--out FOLDER]
// Odometry runs once; with --keep its keyframes are kept in FILE, and a later call takes them from there. --drift turns
// the odometry away about the vertical at a steady rate before loops are looked for. --out writes truth.tum,
// odometry.tum, trajectory.tum and loops.csv. One line of JSON.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <format>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "keyframe_file.hpp"
#include "pllit/eval/evaluate.hpp"
#include "pllit/io/csv.hpp"
#include "pllit/io/tum.hpp"
#include "pllit/loop/loop_closer.hpp"
#include "pllit/sim/sequences.hpp"
#include "pllit/sim/simulation.hpp"
#include "pllit/slam/config_presets.hpp"
#include "pllit/slam/config_yaml.hpp"
#include "pllit/slam/frame_table.hpp"
#include "pllit/slam/keyframe_maker.hpp"
#include "pllit/slam/run.hpp"

namespace {

using namespace pllit;
using bench::KeyframeRun;

struct Options {
  std::string address, preset, motion, keep, out;
  std::vector<std::string> settings;
  double drift_deg_per_min = 0.0;
};

Expected<KeyframeRun> run_odometry_of(const Options& options, const Config& config) {
  const auto address = expanded_address(options.address);
  if (!address) return std::unexpected(address.error());
  auto sim_config = parse_sim_config(*address);
  if (!sim_config) return std::unexpected(sim_config.error());
  std::optional<Trajectory> path;
  if (!options.motion.empty()) {
    auto read = read_tum(options.motion);
    if (!read) return std::unexpected(read.error());
    path = std::move(*read);
  }
  auto simulation = Simulation::make(*sim_config, path);
  if (!simulation) return std::unexpected(simulation.error());
  KeyframeRun run;
  KeyframeMaker maker(config.loop.keyframes);
  RunSummary summary;
  const Rig rig = simulation->rig();
  const auto done = run_odometry(*simulation, rig, config, {.sink = [&](const FrameEstimate& frame) -> Expected<void> {
    if (auto keyframe = maker.take(frame)) {
      run.truth.push_back({keyframe->time, simulation->motion().at(keyframe->time).T_W_I});
      run.keyframes.push_back(std::move(*keyframe));
    }
    return {};
  }},
                                 summary);
  if (!done) return std::unexpected(done.error());
  run.odometry_ms = summary.frame_ms.mean() - summary.stage_ms[0].mean();
  run.duration_s = summary.duration_s;
  return run;
}

void turn_away(std::vector<LoopKeyframe>& keyframes, double deg_per_min) {
  const double rate_rps = deg_per_min * M_PI / 180.0 / 60.0;
  SE3 before = keyframes.empty() ? SE3::Identity() : keyframes.front().T_O_I;
  for (std::size_t k = 1; k < keyframes.size(); ++k) {
    const SE3 step = before.inverse() * keyframes[k].T_O_I;
    before = keyframes[k].T_O_I;
    const double seconds = to_seconds(keyframes[k].time - keyframes[k - 1].time);
    keyframes[k].T_O_I =
        keyframes[k - 1].T_O_I * step * pose_from(exp_so3(rate_rps * seconds * keyframes[k].up_I), Vector3d::Zero());
  }
}

enum class Revisit { none, same_way, reverse, across };

/// Whether the truth comes within 4 m of where it was at least 40 m of way before, and heading which way.
Revisit revisit_at(const KeyframeRun& run, std::size_t k) {
  const auto heading = [&](std::size_t i) {
    const std::size_t next = std::min(i + 1, run.truth.size() - 1), last = i > 0 ? i - 1 : 0;
    return Vector3d((run.truth[next].T_W_I.translation() - run.truth[last].T_W_I.translation()).normalized());
  };
  double nearest_m = 4.0;
  Revisit revisit = Revisit::none;
  for (std::size_t i = 0; i < k && run.keyframes[k].way_m - run.keyframes[i].way_m > 40.0; ++i) {
    const double distance_m = (run.truth[i].T_W_I.translation() - run.truth[k].T_W_I.translation()).norm();
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    const double along = heading(i).dot(heading(k));
    revisit = along > 0.7 ? Revisit::same_way : along < -0.7 ? Revisit::reverse : Revisit::across;
  }
  return revisit;
}

nlohmann::ordered_json recall(const KeyframeRun& run, const LoopCloser& closer) {
  constexpr double near_m = 6.0;
  std::array<int, 4> revisits{}, found{};
  for (std::size_t k = 0; k < run.keyframes.size(); ++k) {
    const auto kind = static_cast<std::size_t>(revisit_at(run, k));
    ++revisits[kind];
    found[kind] += std::ranges::any_of(closer.records(), [&](const LoopRecord& record) {
      return record.accepted &&
             std::abs(run.keyframes[static_cast<std::size_t>(record.later)].way_m - run.keyframes[k].way_m) < near_m;
    });
  }
  nlohmann::ordered_json json;
  constexpr std::array<const char*, 4> names{"", "same_way", "reverse", "across"};
  for (std::size_t i = 1; i < 4; ++i)
    json[names[i]] = {
        {"keyframes", revisits[i]},
        {"recall",
         revisits[i] > 0 ? nlohmann::ordered_json(std::round(1000.0 * found[i] / revisits[i]) / 1000.0) : nullptr}};
  return json;
}

/// Error of a loop against the truth: metres and degrees.
std::pair<double, double> loop_error(const KeyframeRun& run, const LoopRecord& record) {
  const SE3 truth = run.truth[static_cast<std::size_t>(record.earlier)].T_W_I.inverse() *
                    run.truth[static_cast<std::size_t>(record.later)].T_W_I;
  const Vector6 error = difference(truth, record.T_earlier_later);
  return {error.tail<3>().norm(), error.head<3>().norm() * 180.0 / M_PI};
}

bool is_right(const std::pair<double, double>& error) { return error.first < 0.5 && error.second < 2.0; }

Trajectory trajectory_of(const KeyframeRun& run, const std::vector<SE3>& poses) {
  Trajectory trajectory;
  for (std::size_t k = 0; k < poses.size(); ++k) trajectory.push_back({run.keyframes[k].time, poses[k]});
  return trajectory;
}

double ape_m(const KeyframeRun& run, const Trajectory& estimate) {
  const auto scores = evaluate(run.truth, estimate);
  return scores ? scores->ape.translation_m.rmse : std::numeric_limits<double>::quiet_NaN();
}

void write_files(const std::filesystem::path& folder, const KeyframeRun& run, const Trajectory& odometry,
                 const Trajectory& closed, const LoopCloser& closer) {
  std::filesystem::create_directories(folder);
  const std::array<std::pair<const char*, const Trajectory*>, 3> files{
      {{"truth.tum", &run.truth}, {"odometry.tum", &odometry}, {"trajectory.tum", &closed}}};
  for (const auto& [name, trajectory] : files)
    if (const auto done = write_tum(folder / name, *trajectory); !done)
      std::fprintf(stderr, "%s\n", done.error().message.c_str());
  std::vector<std::string> columns = loop_columns();
  columns.insert(columns.end(), {"true_error_m", "true_error_deg"});
  auto csv = CsvWriter::create(folder / "loops.csv", columns);
  for (const LoopRecord& record : closer.records()) {
    std::vector<CsvCell> row = loop_row(record);
    const auto [metres, degrees] = loop_error(run, record);
    row.insert(row.end(), {metres, degrees});
    if (csv) (void)csv->append(row);
  }
}

nlohmann::ordered_json close_loops(const Options& options, const LoopConfig& config, const KeyframeRun& run) {
  LoopCloser closer(config);
  Distribution keyframe_ms;
  const auto begin = std::chrono::steady_clock::now();
  const auto ms = [](auto from) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - from).count();
  };
  for (const LoopKeyframe& keyframe : run.keyframes) {
    const auto from = std::chrono::steady_clock::now();
    closer.add(keyframe);
    keyframe_ms.add(ms(from));
  }
  const auto from = std::chrono::steady_clock::now();
  closer.finish();
  const double finish_ms = ms(from);
  std::vector<SE3> odometry_poses;
  for (const LoopKeyframe& keyframe : run.keyframes) odometry_poses.push_back(keyframe.T_O_I);
  const Trajectory odometry = trajectory_of(run, odometry_poses), closed = trajectory_of(run, closer.poses_M());
  int wrong = 0, accepted = 0;
  double worst_m = 0.0;
  for (const LoopRecord& record : closer.records()) {
    if (!record.accepted) continue;
    ++accepted;
    const auto error = loop_error(run, record);
    wrong += !is_right(error);
    worst_m = std::max(worst_m, error.first);
  }
  if (!options.out.empty()) write_files(options.out, run, odometry, closed, closer);
  const double kilometres = run.keyframes.back().way_m / 1000.0;
  return {{"address", options.address},
          {"drift_deg_per_min", options.drift_deg_per_min},
          {"length_m", std::round(1000.0 * kilometres)},
          {"ape_before_m", ape_m(run, odometry)},
          {"ape_after_m", ape_m(run, closed)},
          {"accepted", accepted},
          {"wrong", wrong},
          {"worst_accepted_m", worst_m},
          {"rejected", closer.records().size() - static_cast<std::size_t>(accepted)},
          {"revisits", recall(run, closer)},
          {"odometry_factor", closer.odometry_factor()},
          {"keyframe_ms",
           {{"mean", keyframe_ms.mean()}, {"p99", keyframe_ms.percentile(0.99)}, {"max", keyframe_ms.max()}}},
          {"tried", closer.records().size()},
          {"finish_ms", finish_ms},
          {"total_s", ms(begin) / 1000.0},
          {"odometry_ms_a_frame", run.odometry_ms},
          {"duration_s", run.duration_s},
          {"mb_per_km", static_cast<double>(closer.bytes()) / 1e6 / kilometres}};
}

Expected<nlohmann::ordered_json> bench_loops(const Options& options) {
  Expected<Config> config = find_config(options.preset);
  for (const std::string& setting : options.settings)
    if (config) config = apply_setting(*config, setting);
  if (!config) return std::unexpected(config.error());
  KeyframeRun run;
  if (!options.keep.empty() && std::filesystem::exists(options.keep)) {
    run = bench::read_keyframes(options.keep);
  } else {
    auto made = run_odometry_of(options, *config);
    if (!made) return std::unexpected(made.error());
    run = std::move(*made);
    if (!options.keep.empty()) bench::write_keyframes(options.keep, run);
  }
  if (run.keyframes.size() < 2) return input_error("fewer than two keyframes");
  turn_away(run.keyframes, options.drift_deg_per_min);
  return close_loops(options, config->loop, run);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program("Loop closing on a simulated drive, scored against the truth");
  Options options;
  program.add_option("address", options.address, "sim:SCENE?key=value&...")->required();
  program.add_option("preset", options.preset, "Preset of the estimator")->required();
  program.add_option("--motion", options.motion, "File of the motion that the address names");
  program.add_option("--drift", options.drift_deg_per_min, "Turn the odometry away, degrees a minute");
  program.add_option("--keep", options.keep, "Where keyframes are kept");
  program.add_option("--out", options.out, "Folder for trajectories and loops.csv");
  program.add_option("--set", options.settings, "Replace one value of the configuration")->take_all()->expected(1);
  CLI11_PARSE(program, argc, argv);
  const auto result = bench_loops(options);
  if (!result) {
    std::fprintf(stderr, "%s\n", result.error().message.c_str());
    return 2;
  }
  std::puts(result->dump().c_str());
  return 0;
}
