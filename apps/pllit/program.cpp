#include "program.hpp"

#include <spdlog/spdlog.h>

#include <format>
#include <ranges>
#include <vector>

#include "pllit/base/words.hpp"

namespace pllit::app {
namespace {

std::vector<std::string> verb_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* verb : program.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

}  // namespace

ExitCode report(const Error& error) {
  spdlog::error("{}", error.message);
  return error.kind == Error::Kind::input ? ExitCode::usage : ExitCode::failed;
}

std::string suggestion_for(const CLI::App& program, int argc, const char* const* argv) {
  const std::vector<std::string> verbs = verb_names(program);
  std::vector<std::string> options = option_names(program);
  bool verb_known = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.starts_with("--")) {
      const std::string name = word.substr(0, word.find('='));
      if (!std::ranges::contains(options, name))
        return std::format("Unknown option '{}'; did you mean '{}'?", name, nearest_word(name, options));
    } else if (!word.starts_with('-') && !verb_known) {
      if (!std::ranges::contains(verbs, word))
        return std::format("Unknown verb '{}'; did you mean '{}'?", word, nearest_word(word, verbs));
      verb_known = true;
      std::ranges::copy(option_names(*program.get_subcommand(word)), std::back_inserter(options));
    }
  }
  return "";
}

std::string complaint_about_empty(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i], before = i > 1 ? argv[i - 1] : "";
    if (word.starts_with("--") && word.find('=') + 1 == word.size())
      return std::format("{} has no value; was a shell variable not set?", word.substr(0, word.size() - 1));
    if (word.empty() && before.starts_with('-'))
      return std::format("The value of {} is empty; was a shell variable not set?", before);
    if (word.empty()) return std::format("Argument {} is empty; was a shell variable not set?", i);
  }
  return "";
}

}  // namespace pllit::app
