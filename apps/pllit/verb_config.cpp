// pllit config: what can be set, and what a preset or file sets it to.
#include <cstdio>
#include <format>
#include <memory>
#include <vector>

#include "pllit/slam/config_presets.hpp"
#include "pllit/slam/config_yaml.hpp"
#include "program.hpp"

namespace pllit::app {
namespace {

struct ConfigOptions {
  std::string source;
  std::vector<std::string> settings;
  bool keys = false, presets = false;
};

void print(std::string_view text) { std::fwrite(text.data(), 1, text.size(), stdout); }

Expected<Config> effective_config(const ConfigOptions& options) {
  Expected<Config> config = options.source.empty() ? Expected<Config>(Config{}) : find_config(options.source);
  for (const std::string& setting : options.settings) {
    if (config) config = apply_setting(*std::move(config), setting);
  }
  if (!config) return config;
  if (const auto checked = check(*config); !checked) return std::unexpected(checked.error());
  return config;
}

void print_presets() {
  for (const Preset& preset : presets()) print(std::format("{:<12} {}\n", preset.name, summary_of(preset)));
}

ExitCode run(const ConfigOptions& options, bool dump) {
  if (options.presets) {
    print_presets();
  } else if (options.keys) {
    print(key_table(KeyGroup::user) + "\nFor experts:\n\n" + key_table(KeyGroup::advanced));
  } else if (!dump) {
    return report({Error::Kind::input, "say what to print: --dump, --keys or --presets; see: pllit config --help"});
  } else {
    const auto config = effective_config(options);
    if (!config) return report(config.error());
    print(dump_config(*config));
  }
  return ExitCode::done;
}

}  // namespace

Verb add_config(CLI::App& program) {
  CLI::App* verb = program.add_subcommand("config", "Print the configuration, its keys or the presets");
  const auto options = std::make_shared<ConfigOptions>();
  CLI::Option* dump =
      verb->add_option("--dump", options->source, "Complete YAML with comments: of the defaults, a preset or a file")
          ->type_name("[PRESET|FILE]")
          ->expected(0, 1);
  CLI::Option* keys = verb->add_flag("--keys", options->keys, "Table of all keys, in Markdown")->excludes(dump);
  verb->add_flag("--presets", options->presets, "Names of the presets")->excludes(dump)->excludes(keys);
  verb->add_option("--set", options->settings, "Change one key of what --dump prints; may be given several times")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  verb->footer(
      "Examples:\n"
      "  pllit config --dump > my.yaml\n"
      "  pllit config --dump hilti2022 --set map.voxel_m=0.2 --set \"rig.lidar.range_m=[1, 60]\"");
  return {verb, [options, dump] { return run(*options, dump->count() > 0); }};
}

}  // namespace pllit::app
