#include "source.hpp"

#include <algorithm>

#include "pllit/io/bag_reader.hpp"
#include "pllit/sim/simulation.hpp"
#include "pllit/slam/config_presets.hpp"
#include "pllit/slam/config_yaml.hpp"

namespace pllit::app {
namespace {

std::optional<TimeUnit> point_time_unit(PointTimeUnit unit) {
  switch (unit) {
    case PointTimeUnit::automatic: return std::nullopt;
    case PointTimeUnit::s: return TimeUnit::seconds;
    case PointTimeUnit::ms: return TimeUnit::milliseconds;
    case PointTimeUnit::us: return TimeUnit::microseconds;
    case PointTimeUnit::ns: return TimeUnit::nanoseconds;
  }
  return std::nullopt;
}

Expected<OpenedSource> open_simulator(const std::string& address) {
  auto simulation = open_simulation(address);
  if (!simulation) return std::unexpected(simulation.error());
  OpenedSource opened{.events = nullptr, .rig = simulation->rig(), .truth = simulation->truth(), .name = address};
  opened.events = std::make_unique<Simulation>(std::move(*simulation));
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
  return OpenedSource{
      .events = std::move(*bags), .rig = make_rig(config.rig), .truth = {}, .name = paths.front().stem().string()};
}

}  // namespace

bool is_simulation(const std::vector<std::string>& sources) {
  return std::ranges::any_of(sources, [](const std::string& source) { return source.starts_with("sim:"); });
}

Expected<OpenedSource> open_source(const std::vector<std::string>& sources, const Config& config, Images images) {
  if (!is_simulation(sources)) return open_recording(sources, config, images);
  if (sources.size() > 1) return input_error("a simulation stands alone: give one sim: address, or bags");
  return open_simulator(sources.front());
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
