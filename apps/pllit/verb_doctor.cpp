// pllit doctor: what a recording holds, what is wrong with it, and the command that would run it.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <filesystem>
#include <format>
#include <memory>
#include <nlohmann/json.hpp>

#include "pllit/io/bag_description.hpp"
#include "pllit/io/bag_reader.hpp"
#include "pllit/io/file.hpp"
#include "pllit/report/overlay.hpp"
#include "pllit/report/pictures.hpp"
#include "pllit/slam/calm_moments.hpp"
#include "pllit/slam/inspection.hpp"
#include "pllit/thermal/image_check.hpp"
#include "program.hpp"
#include "progress_bar.hpp"
#include "source.hpp"

namespace pllit::app {
namespace {

using Json = nlohmann::ordered_json;

struct DoctorOptions {
  std::vector<std::string> sources, settings;
  std::string config, overlay;
  bool json = false, overwrite = false;
};

Json topics_json(const std::vector<std::string>& sources) {
  Json topics = Json::array();
  if (is_simulation(sources)) return topics;
  const auto description = describe_bags({sources.begin(), sources.end()});
  if (!description) return topics;
  for (const TopicInfo& topic : description->topics) {
    topics.push_back({{"name", topic.name},
                      {"type", topic.type},
                      {"messages", topic.count},
                      {"rate_hz", topic.rate_hz()},
                      {"bag", topic.bag.filename().string()}});
  }
  return topics;
}

Json stream_json(const StreamFacts& facts) {
  return {{"messages", facts.count},
          {"rate_hz", facts.rate_hz},
          {"longest_gap_s", facts.longest_gap_s},
          {"gaps", facts.gaps},
          {"not_ascending", facts.not_ascending},
          {"behind_recorder_s", facts.delay_median_s},
          {"jitter_s", facts.delay_spread_s}};
}

Json inspection_json(const Inspection& inspection) {
  Json json{{"imu", stream_json(inspection.imu)},
            {"lidar", stream_json(inspection.lidar)},
            {"camera", stream_json(inspection.camera)}};
  if (inspection.accel_unit) json["imu"]["unit"] = *inspection.accel_unit == AccelUnit::g ? "g" : "m/s2";
  if (inspection.first_second) {
    json["imu"]["still_at_start"] = inspection.first_second->still;
    json["imu"]["gyro_spread_rps"] = inspection.first_second->gyro_spread_rps;
    json["imu"]["accel_spread_mps2"] = inspection.first_second->accel_spread_mps2;
    json["imu"]["mean_rate_rps"] = inspection.first_second->mean_rate_rps.norm();
  }
  json["lidar"]["points_per_scan"] = inspection.points_per_scan;
  json["lidar"]["scan_span_s"] = inspection.scan_span_s;
  json["overlap_s"] = inspection.overlap_s;
  const TimeOffset& offset = inspection.imu_to_lidar;
  json["imu_to_lidar_offset_s"] = offset.found ? Json(offset.offset_s) : Json(nullptr);
  if (!offset.found) json["imu_to_lidar_offset_reason"] = offset.reason;
  json["problems"] = inspection.problems;
  json["warnings"] = inspection.warnings;
  return json;
}

std::string stream_text(const char* name, const Json& stream) {
  if (stream["messages"] == 0) return std::format("{:<8} none\n", name);
  return std::format(
      "{:<8} {} messages, {:.1f} Hz, longest gap {:.3f} s, {} gaps, {} stamps out of order; stamps {:.3f} s before the "
      "recorder's clock, jitter {:.3f} s\n",
      name, stream["messages"].get<int>(), stream["rate_hz"].get<double>(), stream["longest_gap_s"].get<double>(),
      stream["gaps"].get<int>(), stream["not_ascending"].get<int>(), stream["behind_recorder_s"].get<double>(),
      stream["jitter_s"].get<double>());
}

std::string inspection_text(const Json& json) {
  std::string text;
  for (const Json& topic : json["topics"])
    text += std::format("{:<32} {:<36} {:>8} messages {:>8.1f} Hz\n", topic["name"].get<std::string>(),
                        topic["type"].get<std::string>(), topic["messages"].get<std::size_t>(),
                        topic["rate_hz"].get<double>());
  if (json.contains("imu")) {
    const Json &imu = json["imu"], &lidar = json["lidar"];
    text += "\n" + stream_text("IMU", imu);
    if (imu.contains("still_at_start"))
      text += std::format(
          "         accelerometer in {}; {} in the first second (gyro spread {:.4f} rad/s, mean rate {:.4f} rad/s)\n",
          imu["unit"].get<std::string>(), imu["still_at_start"].get<bool>() ? "still" : "moving",
          imu["gyro_spread_rps"].get<double>(), imu["mean_rate_rps"].get<double>());
    text += stream_text("LiDAR", lidar);
    text += std::format("         {:.0f} points a scan, {:.4f} s from first to last; point times: {}\n",
                        lidar["points_per_scan"].get<double>(), lidar["scan_span_s"].get<double>(),
                        json.value("point_times", std::string("as simulated")));
    text += stream_text("camera", json["camera"]);
    text += json["imu_to_lidar_offset_s"].is_number()
                ? std::format("clocks   IMU and LiDAR agree at an offset of {:+.3f} s\n",
                              json["imu_to_lidar_offset_s"].get<double>())
                : std::format("clocks   offset of IMU and LiDAR not found: {}\n",
                              json["imu_to_lidar_offset_reason"].get<std::string>());
  }
  if (json["overlay"].is_string())
    text += std::format(
        "overlay  {}: the LiDAR over {} images. Steps of colour lie on edges of things; where all of them lie beside, "
        "rig.camera or its delay_s is wrong\n",
        json["overlay"].get<std::string>(), json["overlay_images"].get<int>());
  for (const Json& note : json["notes"]) text += "note     " + note.get<std::string>() + "\n";
  for (const Json& warning : json["warnings"]) text += "warning  " + warning.get<std::string>() + "\n";
  for (const Json& problem : json["problems"]) text += "problem  " + problem.get<std::string>() + "\n";
  if (json["run"].is_string()) text += "\nrun it:  " + json["run"].get<std::string>() + "\n";
  return text;
}

std::string shell_quoted(const std::string& word) {
  if (word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+./=:,%@") ==
      std::string::npos)
    return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string run_command(const DoctorOptions& options) {
  std::string command = "./pllit run";
  for (const std::string& source : options.sources) command += " " + shell_quoted(source);
  if (!options.config.empty()) command += " --config " + shell_quoted(options.config);
  for (const std::string& setting : options.settings) command += " --set " + shell_quoted(setting);
  return command;
}

/// Draws the LiDAR over images of calm moments, and tells where.
Expected<void> write_overlay(const DoctorOptions& options, const Rig& rig, const std::vector<CalmMoment>& moments,
                             Json& json) {
  if (moments.empty())
    return input_error("there is nothing to draw for --overlay: no image was taken during a LiDAR scan");
  std::vector<OverlayImage> images;
  for (const CalmMoment& moment : moments) {
    if (const auto fitting = fits(moment.counts, *rig.camera); !fitting) return fitting;
    images.push_back(
        {.counts = moment.counts,
         .points_C = moment.points_C,
         .caption = std::format("{:.1f} s, turning at {:.0f} deg/s", to_seconds(moment.time - moments.front().time),
                                moment.turn_rps * 180.0 / M_PI)});
  }
  const auto written = write_file(options.overlay, png_of(overlay_sheet(images, *rig.camera)));
  if (!written) return std::unexpected(written.error());
  json["overlay"] = options.overlay;
  json["overlay_images"] = images.size();
  return {};
}

/// Reads the whole source and adds what it shows.
Expected<void> inspect(OpenedSource source, const Config& config, const DoctorOptions& options, Json& json) {
  ProgressBar bar("messages", spdlog::should_log(spdlog::level::info));
  Inspector inspector(source.rig, config);
  CalmMoments moments(source.rig);
  long count = 0;
  while (true) {
    const auto event = source.events->next();
    if (!event) return std::unexpected(event.error());
    if (!*event) break;
    inspector.add(**event);
    if (!options.overlay.empty()) moments.add(**event);
    bar.show(source.events->progress(), ++count);
  }
  json.update(inspection_json(inspector.finish()));
  json["notes"] = source.events->notes();
  if (const auto* bags = dynamic_cast<const BagSource*>(source.events.get()))
    if (const auto layout = bags->time_layout())
      json["point_times"] = std::format("field {} ({}), {} in {}", layout->field, layout->datatype,
                                        layout->absolute ? "absolute" : "relative", name_of(layout->unit));
  if (!options.overlay.empty()) return write_overlay(options, source.rig, moments.moments(), json);
  return {};
}

Expected<Json> diagnose(const DoctorOptions& options) {
  const auto config = read_config(options.config, options.settings);
  if (!config) return std::unexpected(config.error());
  if (!options.overlay.empty() && std::filesystem::exists(options.overlay) && !options.overwrite)
    return input_error(std::format("'{}' exists; give another name with --overlay, or --overwrite", options.overlay));
  Json json{{"schema_version", kSchemaVersion},
            {"topics", topics_json(options.sources)},
            {"notes", Json::array()},
            {"warnings", Json::array()},
            {"problems", Json::array()},
            {"overlay", nullptr},
            {"run", nullptr}};
  auto source = open_source(options.sources, *config, Images::wanted);
  if (!source && json["topics"].empty()) return std::unexpected(source.error());
  if (source && !options.overlay.empty() && !source->rig.camera)
    return input_error("--overlay needs a camera, and the configuration has none: give rig.camera (see config --dump)");
  const auto inspected =
      source ? inspect(std::move(*source), *config, options, json) : Expected<void>(std::unexpected(source.error()));
  if (!inspected) json["problems"].push_back(inspected.error().message);
  if (json["problems"].empty()) json["run"] = run_command(options);
  return json;
}

ExitCode run(const DoctorOptions& options) {
  const auto json = diagnose(options);
  if (!json) return report(json.error());
  std::fputs((options.json ? json->dump(2) + "\n" : inspection_text(*json)).c_str(), stdout);
  return (*json)["problems"].empty() ? ExitCode::done : ExitCode::usage;
}

}  // namespace

Verb add_doctor(CLI::App& program) {
  CLI::App* verb = program.add_subcommand("doctor", "Examine a recording: rates, gaps, clocks, units, what is missing");
  const auto options = std::make_shared<DoctorOptions>();
  verb->add_option("source", options->sources, "ROS 1 bags of one recording, or sim:SCENE?key=value&...")
      ->type_name("SOURCE...")
      ->required();
  verb->add_option("--config", options->config, "Preset or YAML file, for topics and extrinsics")
      ->type_name("FILE|PRESET");
  verb->add_option("--set", options->settings, "Replace one value of the configuration")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1);
  verb->add_option("--overlay", options->overlay, "Draw the LiDAR over images, to see a wrong extrinsic before a run")
      ->type_name("FILE.png");
  verb->add_flag("--overwrite", options->overwrite, "Replace the picture if it exists");
  verb->add_flag("--json", options->json, "Print JSON");
  verb->footer(
      "Examples:\n  pllit doctor drive.bag --config kitti\n  pllit doctor walk.bag --config inspection --overlay "
      "overlay.png");
  return {verb, [options] { return run(*options); }};
}

}  // namespace pllit::app
