#include "pllit/slam/config_yaml.hpp"

#include <format>
#include <set>

#include "pllit/base/strict_yaml.hpp"
#include "pllit/slam/config_value.hpp"

namespace pllit {
namespace {

/// Reads a tree of sections into the list of keys and collects what is wrong with it.
class Reader {
 public:
  Reader(const KeyList& keys, std::string_view source_name) : keys_(keys), problems_(source_name) {}

  void read(const YAML::Node& map, const std::string& prefix) {
    for (const auto& entry : map) {
      if (problems_.enough()) return;
      if (entry.first.IsScalar()) {
        read_entry(entry.first, prefix + entry.first.Scalar(), entry.second);
      } else {
        complain(entry.first, "a key must be a single word");
      }
    }
  }
  void complain(const YAML::Node& where, std::string_view what) { problems_.add(where, what); }
  Expected<void> result() const { return problems_.result(); }

 private:
  void read_entry(const YAML::Node& name, const std::string& path, const YAML::Node& value) {
    if (!seen_.insert(path).second) return complain(name, in_quotes(path) + " is given twice");
    if (keys_.find_section(path) != nullptr) {
      if (value.IsMap()) return read(value, path + ".");
      if (!value.IsNull()) complain(name, path + " is a section: put its keys below it, indented");
    } else if (const Key* key = keys_.find(path)) {
      if (const auto done = read_value(*key, value); !done) complain(name, path + ": " + done.error());
    } else {
      complain(name, std::format("unknown key {}; did you mean '{}'?", in_quotes(path), keys_.nearest(path)));
    }
  }

  const KeyList& keys_;
  std::set<std::string> seen_;
  YamlProblems problems_;
};

}  // namespace

Expected<Config> load_config(std::string_view yaml_text, std::string_view source_name) {
  const auto root = parse_yaml(yaml_text, source_name);
  if (!root) return std::unexpected(root.error());
  Config config;
  const KeyList keys = keys_of(config);
  Reader reader(keys, source_name);
  if (root->IsMap()) {
    reader.read(*root, "");
  } else if (!root->IsNull()) {
    reader.complain(*root, "expected 'section:' lines with keys below them; see: pllit config --dump");
  }
  if (const auto result = reader.result(); !result) return std::unexpected(result.error());
  if (const auto result = check(config); !result) return in_context(std::string(source_name), result.error());
  return config;
}

Expected<Config> apply_setting(Config config, std::string_view setting) {
  const std::string where = "setting " + in_quotes(setting);
  const auto equals = setting.find('=');
  if (equals == std::string_view::npos) return input_error(where + ": write KEY=VALUE, for example map.voxel_m=0.3");
  const std::string_view path = setting.substr(0, equals), text = setting.substr(equals + 1);
  const KeyList keys = keys_of(config);
  const Key* key = keys.find(path);
  if (key == nullptr)
    return input_error(
        std::format("{}: unknown key {}; did you mean '{}'?", where, in_quotes(path), keys.nearest(path)));
  // Texts and words are taken as they stand: the shell has had its say about quotes.
  const bool plain = std::holds_alternative<std::string*>(key->value) || std::holds_alternative<Choice>(key->value);
  const auto node = plain ? YAML::Node(std::string(text)) : parse_yaml(text, where);
  if (!node) return std::unexpected(node.error());
  if (const auto done = read_value(*key, *node); !done) return input_error(where + ": " + done.error());
  return config;
}

}  // namespace pllit
