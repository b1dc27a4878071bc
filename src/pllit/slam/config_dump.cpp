#include <algorithm>
#include <format>

#include "pllit/slam/config_value.hpp"
#include "pllit/slam/config_yaml.hpp"

namespace pllit {
namespace {

std::string indent_of(std::string_view path) { return std::string(2 * std::ranges::count(path, '.'), ' '); }
std::string_view name_of(std::string_view path) { return path.substr(path.rfind('.') + 1); }  // npos + 1 is 0

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) {
    if (!part.empty()) text += (text.empty() ? "" : "; ") + part;
  }
  return text;
}

/// Opens the section `path` and those around it, as far as they are not open yet.
void open_section(const KeyList& keys, std::string_view path, std::vector<std::string>& opened, std::string& text) {
  if (path.empty() || std::ranges::contains(opened, path)) return;
  const auto dot = path.rfind('.');
  open_section(keys, dot == std::string_view::npos ? "" : path.substr(0, dot), opened, text);
  const KeySection& section = *keys.find_section(path);
  text += std::format("\n{0}# {1}\n{0}{2}:\n", indent_of(path), section.doc, name_of(path));
  opened.emplace_back(path);
}

bool belongs(const Key& key, KeyGroup group) {
  return key.path.starts_with(kAdvanced) == (group == KeyGroup::advanced);
}

std::string in_cell(std::string text) {  // a bar would end the cell
  for (auto at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, "\\");
  return text;
}

}  // namespace

std::string dump_config(const Config& config) {
  Config shown = config, defaults;
  const KeyList keys = keys_of(shown), default_keys = keys_of(defaults);
  std::string text = "# All keys with meaning, unit, range and default. What a file leaves out keeps its default.\n";
  std::vector<std::string> opened;
  for (std::size_t i = 0; i < keys.keys.size(); ++i) {
    const Key& key = keys.keys[i];
    const auto dot = key.path.rfind('.');
    const std::string indent = indent_of(key.path), section = dot == std::string::npos ? "" : key.path.substr(0, dot);
    open_section(keys, section, opened, text);
    if (section.empty()) text += '\n';
    text += std::format("{0}# {1}\n{0}# {2}\n{0}{3}: {4}\n", indent, key.doc,
                        joined({key.unit, range_text(key), "default " + value_text(default_keys.keys[i].value)}),
                        name_of(key.path), value_text(key.value));
  }
  return text;
}

std::string key_table(KeyGroup group) {
  Config defaults;
  std::string text = "| key | default | unit | range | meaning |\n|---|---|---|---|---|\n";
  for (const Key& key : keys_of(defaults).keys) {
    if (belongs(key, group))
      text += std::format("| `{}` | `{}` | {} | {} | {} |\n", key.path, value_text(key.value), key.unit,
                          in_cell(range_text(key)), in_cell(key.doc));
  }
  return text;
}

bool operator==(const Config& a, const Config& b) {
  Config left = a, right = b;
  const auto same = [](const Key& x, const Key& y) { return value_text(x.value) == value_text(y.value); };
  return std::ranges::equal(keys_of(left).keys, keys_of(right).keys, same);
}

}  // namespace pllit
