// The configuration as text: YAML in and out, single settings, and the table of keys for the documentation.
#pragma once

#include <string>
#include <string_view>

#include "pllit/slam/config.hpp"

namespace pllit {

/// The defaults, overwritten by what the YAML text names. Errors (input) name every unknown key with the nearest known
/// one, every key given twice, and every value of the wrong type, out of range or not finite, each as SOURCE:LINE: KEY:
/// what.
Expected<Config> load_config(std::string_view yaml_text, std::string_view source_name);

/// `config` with one value replaced: "map.voxel_m=0.3". Lists and poses are written as in YAML: "rig.lidar.range_m=[1,
/// 80]". Rules that span several keys are not looked at; call `check` after the last setting.
Expected<Config> apply_setting(Config config, std::string_view setting);

/// YAML with every key, its meaning, unit, range and default as comments. Loading it gives `config` back to the bit.
std::string dump_config(const Config& config);

/// Markdown table of the keys that users are expected to know, or of those under `advanced`.
enum class KeyGroup { user, advanced };
std::string key_table(KeyGroup group);

}  // namespace pllit
