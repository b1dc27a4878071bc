#include "source.hpp"

#include <algorithm>
#include <cstdlib>
#include <format>
#include <nlohmann/json.hpp>

#include "pllit/io/bag_reader.hpp"
#include "pllit/io/tum.hpp"
#include "pllit/sim/sequences.hpp"
#include "pllit/slam/config_presets.hpp"
#include "pllit/slam/config_yaml.hpp"

namespace pllit::app {
namespace {

std::optional<TimeUnit> point_time_unit(PointTimeUnit unit) {
  switch (unit) {
    case PointTimeUnit::automatic:
      return std::nullopt;
    case PointTimeUnit::s:
      return TimeUnit::seconds;
    case PointTimeUnit::ms:
      return TimeUnit::milliseconds;
    case PointTimeUnit::us:
      return TimeUnit::microseconds;
    case PointTimeUnit::ns:
      return TimeUnit::nanoseconds;
  }
  return std::nullopt;
}

Expected<OpenedSource> open_simulator(const std::string& address, Images images) {
  auto simulation = open_simulation_with_files(address, images);
  if (!simulation) return std::unexpected(simulation.error());
  OpenedSource opened{.events = nullptr,
                      .rig = simulation->rig(),
                      .sees_heat = simulation->is_thermal(),
                      .truth = simulation->truth(),
                      .scene_json = {},
                      .name = address};
  auto events = std::make_unique<Simulation>(std::move(*simulation));
  opened.scene_json = [&truth = *events, address] { return scene_json(truth.scene_truth(), address).dump(2); };
  opened.events = std::move(events);
  return opened;
}

Expected<OpenedSource> open_recording(const std::vector<std::string>& sources, const Config& config, Images images) {
  const std::vector<std::filesystem::path> paths(sources.begin(), sources.end());
  auto bags = open_bags(paths, {.imu_topic = config.input.imu_topic,
                                .lidar_topic = config.input.lidar_topic,
                                .image_topic = config.input.image_topic,
                                .with_images = images == Images::wanted,
                                .point_time_unit = point_time_unit(config.input.lidar_time_unit)});
  if (!bags) return std::unexpected(bags.error());
  return OpenedSource{.events = std::move(*bags),
                      .rig = make_rig(config.rig),
                      .sees_heat = config.thermography.unit_choice != UnitChoice::light,
                      .truth = {},
                      .scene_json = {},
                      .name = paths.front().stem().string()};
}

/// Where a motion's file lies: as it is named, or among the recordings.
Expected<std::filesystem::path> motion_file(const std::filesystem::path& name) {
  std::vector<std::filesystem::path> places{name};
  if (const char* data = std::getenv("PLLIT_DATA"))
    places.push_back(std::filesystem::path(data) / "trajectories" / name);
  places.push_back(std::filesystem::path("../shared/data/trajectories") / name);
  std::string tried;
  for (const auto& place : places) {
    if (std::filesystem::is_regular_file(place)) return place;
    tried += (tried.empty() ? "" : ", ") + place.string();
  }
  return input_error(
      std::format("the motion's file is missing; looked for {} (the folder can be set with PLLIT_DATA)", tried));
}

}  // namespace

bool is_simulation(const std::vector<std::string>& sources) {
  return std::ranges::any_of(sources, [](const std::string& source) { return source.starts_with("sim:"); });
}

Expected<Simulation> open_simulation_with_files(const std::string& address, Images images) {
  const auto expanded = expanded_address(address);
  if (!expanded) return std::unexpected(expanded.error());
  auto config = parse_sim_config(*expanded);
  if (!config) return std::unexpected(config.error());
  if (images == Images::skipped) config->images = SimConfig::Images::none;
  std::optional<Trajectory> path;
  if (!config->motion.empty()) {
    const auto file = motion_file(config->motion);
    if (!file) return std::unexpected(file.error());
    auto read = read_tum(*file);
    if (!read) return std::unexpected(read.error());
    path = std::move(*read);
  }
  return Simulation::make(*config, path);
}

Expected<OpenedSource> open_source(const std::vector<std::string>& sources, const Config& config, Images images) {
  if (!is_simulation(sources)) return open_recording(sources, config, images);
  if (sources.size() > 1) return input_error("a simulation stands alone: give one sim: address, or bags");
  return open_simulator(sources.front(), images);
}

Expected<Config> read_config(const std::string& name_or_path, const std::vector<std::string>& settings) {
  Expected<Config> config = name_or_path.empty() ? Config{} : find_config(name_or_path);
  for (const std::string& setting : settings) {
    if (!config) return config;
    config = apply_setting(*config, setting);
  }
  if (!config) return config;
  if (const auto checked = check(*config); !checked) return std::unexpected(checked.error());
  return config;
}

}  // namespace pllit::app
