#include "pllit/report/severity_file.hpp"

#include <algorithm>
#include <array>
#include <format>
#include <map>

#include "pllit/base/strict_yaml.hpp"

namespace pllit {
namespace {

constexpr std::size_t kLongestText = 200;
const Limits kRise_K{0.0, 2000.0};

std::string words_at(const std::map<std::string, YAML::Node>& entries, const std::string& key, const YAML::Node& where,
                     YamlProblems& problems) {
  const auto entry = entries.find(key);
  if (entry == entries.end()) {
    problems.add(where, std::format("{} is missing: give {}: and a few words", key, key));
    return "";
  }
  const std::string text = entry->second.IsScalar() ? entry->second.Scalar() : "";
  const bool printable = std::ranges::none_of(text, [](unsigned char c) { return c < ' ' || c == 0x7f; });
  if (text.empty() || text.size() > kLongestText || !printable)
    problems.add(entry->second, std::format("{}: must be one line of 1 to {} bytes, but is {}", key, kLongestText,
                                            shape_of(entry->second)));
  return text;
}

SeverityClass class_of(const YAML::Node& node, YamlProblems& problems) {
  static const std::array<std::string, 3> keys{"from_K", "name", "action"};
  SeverityClass result;
  const auto entries = entries_of(node, "a class", keys, problems);
  if (!node.IsMap()) return result;
  result.name = words_at(entries, "name", node, problems);
  result.action = words_at(entries, "action", node, problems);
  const auto from = entries.find("from_K");
  if (from == entries.end()) {
    problems.add(node, "from_K is missing: give the rise in kelvin from which on the class holds");
    return result;
  }
  const auto rise_K = number_of<double>(from->second, kRise_K);
  if (rise_K)
    result.from_k = *rise_K;
  else
    problems.add(from->second, "from_K: " + rise_K.error());
  return result;
}

}  // namespace

Expected<SeverityTable> parse_severity(std::string_view yaml_text, std::string_view source_name) {
  static const std::array<std::string, 2> keys{"scheme", "classes"};
  const auto root = parse_yaml(yaml_text, source_name);
  if (!root) return std::unexpected(root.error());
  YamlProblems problems(source_name);
  const auto entries = entries_of(*root, "the file", keys, problems);
  SeverityTable table;
  if (root->IsMap()) table.scheme = words_at(entries, "scheme", *root, problems);
  const auto classes = entries.find("classes");
  const bool listed = classes != entries.end() && classes->second.IsSequence() && classes->second.size() > 0;
  if (root->IsMap() && !listed)
    problems.add(*root, "classes: must be a list with at least one '- {from_K: ..., name: ..., action: ...}'");
  for (std::size_t i = 0; listed && i < classes->second.size() && !problems.enough(); ++i) {
    const YAML::Node node = classes->second[i];
    const bool clean = !problems.any();
    SeverityClass next = class_of(node, problems);
    if (clean && !problems.any() && !table.classes.empty() && next.from_k <= table.classes.back().from_k)
      problems.add(node,
                   std::format("from_K: {} does not exceed the {} of the class before; list them from the mildest "
                               "to the worst",
                               next.from_k, table.classes.back().from_k));
    if (!next.name.empty() && std::ranges::contains(table.classes, next.name, &SeverityClass::name))
      problems.add(node, std::format("name: {} is that of another class too", in_quotes(next.name)));
    table.classes.push_back(std::move(next));
  }
  if (const auto result = problems.result(); !result) return std::unexpected(result.error());
  return table;
}

}  // namespace pllit
