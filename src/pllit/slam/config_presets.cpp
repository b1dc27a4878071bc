#include "pllit/slam/config_presets.hpp"

#include <algorithm>
#include <filesystem>
#include <format>
#include <fstream>
#include <iterator>
#include <vector>

#include "pllit/base/words.hpp"
#include "pllit/slam/config_yaml.hpp"

namespace pllit {
namespace {

Expected<Config> load_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.good() && !file.eof()) return input_error(std::format("configuration '{}' cannot be read", path));
  return load_config(text, path);
}

}  // namespace

std::string_view summary_of(const Preset& preset) {
  const std::string_view first_line = preset.yaml.substr(0, preset.yaml.find('\n'));
  return first_line.substr(std::min(first_line.find_first_not_of("# "), first_line.size()));
}

Expected<Config> find_config(const std::string& name_or_path) {
  const auto preset = std::ranges::find(presets(), name_or_path, &Preset::name);
  if (preset != presets().end()) return load_config(preset->yaml, std::format("preset {}", preset->name));
  if (std::filesystem::is_regular_file(name_or_path)) return load_file(name_or_path);
  std::vector<std::string> names;
  std::string listed;
  for (const Preset& known : presets()) {
    names.emplace_back(known.name);
    listed += std::format("{}{}", listed.empty() ? "" : ", ", known.name);
  }
  return input_error(std::format("configuration '{}' is neither a file nor a preset ({}); did you mean '{}'?",
                                 name_or_path, listed, nearest_word(name_or_path, names)));
}

}  // namespace pllit
