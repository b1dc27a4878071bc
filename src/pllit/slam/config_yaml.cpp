#include "pllit/slam/config_yaml.hpp"

#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <format>
#include <set>
#include <sstream>

#include "pllit/slam/config_value.hpp"

namespace pllit {
namespace {

constexpr std::size_t kMaxBytes = 256 * 1024;  // fifty times a full configuration
constexpr std::size_t kMaxProblems = 10;       // enough to repair a file in one go

class IgnoreEvents : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

/// YAML::Load leaves the rest of a text unread, and YAML::LoadAll (yaml-cpp 0.8) never returns where the rest is a
/// stray '}'.
bool holds_more_than_one_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  IgnoreEvents ignore;
  parser.HandleNextDocument(ignore);
  return static_cast<bool>(parser);
}

Expected<YAML::Node> parse(std::string_view text, std::string_view source_name) {
  if (text.size() > kMaxBytes)
    return input_error(std::format("{}: {} bytes are too many for a configuration (at most {}); is it another file?",
                                   source_name, text.size(), kMaxBytes));
  try {
    if (holds_more_than_one_document(std::string(text)))
      return input_error(std::format(
          "{}: more text follows the end of the YAML document; is there a '---', or a bracket too many?", source_name));
    return YAML::Load(std::string(text));
  } catch (const YAML::DeepRecursion& error) {
    return input_error(
        std::format("{}:{}: nested far too deeply for a configuration", source_name, error.mark.line + 1));
  } catch (const YAML::Exception& error) {
    return input_error(std::format("{}:{}: not valid YAML (column {}): {}", source_name, error.mark.line + 1,
                                   error.mark.column + 1, error.msg));
  }
}

/// Reads a tree of sections into the list of keys and collects what is wrong with it.
class Reader {
 public:
  Reader(const KeyList& keys, std::string_view source_name) : keys_(keys), source_name_(source_name) {}

  void read(const YAML::Node& map, const std::string& prefix) {
    for (const auto& entry : map) {
      if (problems_.size() >= kMaxProblems) return;
      if (entry.first.IsScalar()) {
        read_entry(entry.first, prefix + entry.first.Scalar(), entry.second);
      } else {
        complain(entry.first, "a key must be a single word");
      }
    }
  }
  void complain(const YAML::Node& where, std::string_view what) {
    problems_.push_back(std::format("{}:{}: {}", source_name_, std::max(where.Mark().line, 0) + 1, what));
  }
  Expected<void> result() const {
    std::string message;
    for (const std::string& problem : problems_) message += (message.empty() ? "" : "\n") + problem;
    if (problems_.empty()) return {};
    return input_error(message);
  }

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
  std::string_view source_name_;
  std::set<std::string> seen_;
  std::vector<std::string> problems_;
};

}  // namespace

Expected<Config> load_config(std::string_view yaml_text, std::string_view source_name) {
  const auto root = parse(yaml_text, source_name);
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
  const auto node = plain ? YAML::Node(std::string(text)) : parse(text, where);
  if (!node) return std::unexpected(node.error());
  if (const auto done = read_value(*key, *node); !done) return input_error(where + ": " + done.error());
  return config;
}

}  // namespace pllit
