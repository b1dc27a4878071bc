#include "pllit/base/strict_yaml.hpp"

#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <format>
#include <sstream>
#include <type_traits>

#include "pllit/base/words.hpp"

namespace pllit {
namespace {

constexpr std::size_t kMaxBytes = 256 * 1024;  // fifty times a full configuration

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

}  // namespace

Expected<YAML::Node> parse_yaml(std::string_view text, std::string_view source_name) {
  if (text.size() > kMaxBytes)
    return input_error(std::format("{}: {} bytes are too many for a file of settings (at most {}); is it another file?",
                                   source_name, text.size(), kMaxBytes));
  try {
    if (holds_more_than_one_document(std::string(text)))
      return input_error(std::format(
          "{}: more text follows the end of the YAML document; is there a '---', or a bracket too many?", source_name));
    return YAML::Load(std::string(text));
  } catch (const YAML::DeepRecursion& error) {
    return input_error(std::format("{}:{}: nested far too deeply for a file of settings", source_name,
                                   std::max(error.mark.line, 0) + 1));
  } catch (const YAML::Exception& error) {
    return input_error(std::format("{}:{}: not valid YAML (column {}): {}", source_name, error.mark.line + 1,
                                   error.mark.column + 1, error.msg));
  }
}

std::string in_quotes(std::string_view text) {
  std::string shown = "'";
  for (const char c : text.substr(0, 60)) shown += c >= ' ' && c < '\x7f' ? c : '?';
  return shown + (text.size() > 60 ? "...'" : "'");
}

std::string shape_of(const YAML::Node& node) {
  if (node.IsSequence()) return std::format("a list of {}", node.size());
  if (node.IsMap()) return "a group of keys";
  return node.IsScalar() ? in_quotes(node.Scalar()) : "empty";
}

template <class T>
std::expected<T, std::string> number_of(const YAML::Node& node, const Limits& limits) {
  using Complaint = std::unexpected<std::string>;
  constexpr std::string_view kind = std::is_integral_v<T> ? "a whole number" : "a number";
  const std::string text = node.IsScalar() ? node.Scalar() : "";
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  T value{};
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error == std::errc::result_out_of_range)
    return Complaint(std::format("{} is too large or too small", in_quotes(text)));
  if (error != std::errc() || stop != end) return Complaint(std::format("must be {}, but is {}", kind, shape_of(node)));
  if (!std::isfinite(static_cast<double>(value))) return Complaint(std::format("{} is not a finite number", text));
  const auto as_double = static_cast<double>(value);
  if (as_double < limits.min || as_double > limits.max)
    return Complaint(std::format("{} is out of range; give {} to {}", value, limits.min, limits.max));
  return value;
}
template std::expected<int, std::string> number_of(const YAML::Node&, const Limits&);
template std::expected<double, std::string> number_of(const YAML::Node&, const Limits&);

void YamlProblems::add(int line, std::string_view what) {
  problems_.push_back(std::format("{}:{}: {}", source_name_, line, what));
}

Expected<void> YamlProblems::result() const {
  if (problems_.empty()) return {};
  std::string message;
  for (const std::string& problem : problems_) message += (message.empty() ? "" : "\n") + problem;
  return input_error(message);
}

std::map<std::string, YAML::Node> entries_of(const YAML::Node& node, std::string_view what,
                                             std::span<const std::string> known, YamlProblems& problems) {
  std::map<std::string, YAML::Node> entries;
  if (!node.IsMap()) {
    std::string listed;
    for (const std::string& key : known) listed += (listed.empty() ? "" : ", ") + key;
    problems.add(node, std::format("{} must hold keys ({}), but is {}", what, listed, shape_of(node)));
    return entries;
  }
  for (const auto& entry : node) {
    if (problems.enough()) return entries;
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    if (!entry.first.IsScalar())
      problems.add(entry.first, "a key must be a single word");
    else if (!std::ranges::contains(known, key))
      problems.add(entry.first, std::format("unknown key {} of {}; did you mean '{}'?", in_quotes(key), what,
                                            nearest_word(key.substr(0, 100), known)));
    else if (!entries.emplace(key, entry.second).second)
      problems.add(entry.first, in_quotes(key) + " is given twice");
  }
  return entries;
}

}  // namespace pllit
