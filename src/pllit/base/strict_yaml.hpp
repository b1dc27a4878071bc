// YAML files that people write, read strictly: what is not understood is an error that names file and line.
#pragma once

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <expected>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/base/limits.hpp"

namespace pllit {

/// The one document of a text; a null node where it is empty. Errors (input): SOURCE:LINE: what is wrong.
Expected<YAML::Node> parse_yaml(std::string_view text, std::string_view source_name);

/// Foreign text for a message: one line, printable, not long.
std::string in_quotes(std::string_view text);

/// What a node is, for a message: "a list of 3", "'big'", "empty".
std::string shape_of(const YAML::Node& node);

/// A finite number within the limits, an int or a double, or in one clause what is wrong with it.
template <class T>
std::expected<T, std::string> number_of(const YAML::Node& node, const Limits& limits);

/// What is wrong with a file, collected so that it can be repaired in one go.
class YamlProblems {
 public:
  explicit YamlProblems(std::string_view source_name) : source_name_(source_name) {}

  void add(const YAML::Node& where, std::string_view what) { add(line_of(where), what); }
  void add(int line, std::string_view what);
  bool any() const { return !problems_.empty(); }
  /// So many that more would not help.
  bool enough() const { return problems_.size() >= 10; }
  /// An input error with a line for each problem, SOURCE:LINE: WHAT.
  Expected<void> result() const;

  /// Counted from one.
  static int line_of(const YAML::Node& node) { return std::max(node.Mark().line, 0) + 1; }

 private:
  std::string source_name_;
  std::vector<std::string> problems_;
};

/// The values of a group of keys, `what` by name. Keys that are not among `known`, keys given twice and a node that is
/// no group become problems.
std::map<std::string, YAML::Node> entries_of(const YAML::Node& node, std::string_view what,
                                             std::span<const std::string> known, YamlProblems& problems);

}  // namespace pllit
