// A SOURCE of the command line: bags of one recording, or the simulator.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sim/simulation.hpp"
#include "pllit/slam/config.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit::app {

struct OpenedSource {
  std::unique_ptr<EventSource> events;
  Rig rig;
  bool sees_heat = true;  ///< the camera, where there is one
  Trajectory truth;       ///< empty for recordings
  std::function<std::string()>
      scene_json;    ///< what a simulation knows besides, as far as it has run; empty for recordings
  std::string name;  ///< for the session folder
};

enum class Images { skipped, wanted };

/// Opens `sim:...` or the bags. The simulator brings its own rig, as its data sheets say; a recording takes the
/// configuration's.
Expected<OpenedSource> open_source(const std::vector<std::string>& sources, const Config& config,
                                   Images images = Images::skipped);
/// Opens `sim:...` and reads the file that it names.
Expected<Simulation> open_simulation_with_files(const std::string& address, Images images);
bool is_simulation(const std::vector<std::string>& sources);

/// The configuration of --config and --set: a preset, a file, or the defaults; checked as a whole.
Expected<Config> read_config(const std::string& name_or_path, const std::vector<std::string>& settings);

}  // namespace pllit::app
