// Configurations that come with the program: the files of config/, compiled in so that they are found from anywhere.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "pllit/slam/config.hpp"

namespace pllit {

struct Preset {
  std::string_view name;  ///< the file's name without .yaml
  std::string_view yaml;  ///< its text; the first comment line says what it is for
};

/// All presets, by name.
std::span<const Preset> presets();

/// One line on what the preset is for.
std::string_view summary_of(const Preset& preset);

/// The configuration of a preset, or of a YAML file where no preset has that name. Errors (input) as those of
/// load_config; a name that is neither lists the presets.
Expected<Config> find_config(const std::string& name_or_path);

}  // namespace pllit
