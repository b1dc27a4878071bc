#include "pllit/sim/config.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <format>
#include <functional>
#include <initializer_list>
#include <optional>
#include <ranges>
#include <string>
#include <system_error>
#include <vector>

namespace pllit {
namespace {

template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// One key: how to set it, and what it wants, for the message where that fails.
struct Key {
  std::string_view name;
  std::string wants;
  std::function<bool(SimConfig&, std::string_view)> set;
};

Key number_key(std::string_view name, double SimConfig::* member, double low, double high, std::string_view unit) {
  return {name, std::format("a number of {} from {} to {}", unit, low, high),
          [=](SimConfig& config, std::string_view text) {
            const auto number = parse_number<double>(text);
            if (!number || !(*number >= low && *number <= high)) return false;
            config.*member = *number;
            return true;
          }};
}

Key interval_key(std::string_view name, FaultInterval SimFaults::* member) {
  return {name, "FROM:TO in seconds since the start, with 0 <= FROM < TO",
          [=](SimConfig& config, std::string_view text) {
            const std::size_t colon = text.find(':');
            if (colon == text.npos) return false;
            const auto from = parse_number<double>(text.substr(0, colon));
            const auto to = parse_number<double>(text.substr(colon + 1));
            if (!from || !to || !(*from >= 0.0 && *from < *to && std::isfinite(*to))) return false;
            config.faults.*member = {*from, *to};
            return true;
          }};
}

template <class Choice>
struct Option {
  std::string_view name;
  Choice value;
};

template <class Choice>
Key choice_key(std::string_view name, Choice SimConfig::* member, std::initializer_list<Option<Choice>> choices) {
  const std::vector<Option<Choice>> options(choices);
  std::string wants;
  for (const auto& option : options) wants += (wants.empty() ? "" : " or ") + std::string(option.name);
  return {name, wants, [=](SimConfig& config, std::string_view text) {
            const auto found = std::ranges::find(options, text, &Option<Choice>::name);
            if (found == options.end()) return false;
            config.*member = found->value;
            return true;
          }};
}

bool set_seed(SimConfig& config, std::string_view text) {
  const auto seed = parse_number<std::uint64_t>(text);
  if (seed) config.seed = *seed;
  return seed.has_value();
}

std::vector<Key> all_keys() {
  using C = SimConfig;
  return {
      {"seed", "a whole number from 0 to 18446744073709551615", set_seed},
      number_key("duration", &C::duration_s, 3.0, 36000.0, "seconds"),
      number_key("imu_rate", &C::imu_rate_hz, 10.0, 1000.0, "Hz"),
      number_key("speed", &C::speed_mps, 0.1, 3.0, "m/s"),
      choice_key("motion", &C::motion, {{"walk", C::Carried::walk}, {"shake", C::Carried::shake}}),
      choice_key("lidar", &C::lidar, {{"ring32", C::Lidar::ring32}, {"ring16", C::Lidar::ring16}}),
      choice_key("ideal", &C::ideal, {{"0", false}, {"1", true}}),
      choice_key("accel_unit", &C::accel_in_g, {{"mps2", false}, {"g", true}}),
      interval_key("imu_gap", &SimFaults::imu_gap),
      interval_key("lidar_gap", &SimFaults::lidar_gap),
      interval_key("time_back", &SimFaults::time_back),
      interval_key("duplicates", &SimFaults::duplicates),
      interval_key("imu_nan", &SimFaults::imu_nan),
      interval_key("late_scans", &SimFaults::late_scans),
      interval_key("swapped_imu", &SimFaults::swapped_imu),
  };
}

std::string names_of(const std::vector<Key>& keys) {
  std::string names;
  for (const Key& key : keys) names += (names.empty() ? "" : ", ") + std::string(key.name);
  return names;
}

/// What is wrong with `assignment` (key=value), or nothing after it has been applied and its key taken off `keys`.
std::optional<std::string> apply(std::string_view assignment, std::vector<Key>& keys, SimConfig& config) {
  const std::size_t equals = assignment.find('=');
  if (equals == assignment.npos) return std::format("\"{}\" is not of the form key=value", assignment);
  const std::string_view name = assignment.substr(0, equals), value = assignment.substr(equals + 1);
  const auto key = std::ranges::find(keys, name, &Key::name);
  if (key == keys.end())
    return std::format("\"{}\" is unknown or given twice; the keys left are {}", name, names_of(keys));
  if (!key->set(config, value)) return std::format("{}={}: {} wants {}", name, value, name, key->wants);
  keys.erase(key);
  return std::nullopt;
}

}  // namespace

Expected<SimConfig> parse_sim_config(std::string_view source) {
  const auto wrong = [&](const std::string& what) {
    return input_error(std::format("simulation \"{}\": {}", source, what));
  };
  constexpr std::string_view kPrefix = "sim:";
  if (!source.starts_with(kPrefix)) return wrong("it must start with sim:, as in sim:room?seed=3&duration=30");
  const std::size_t question = source.find('?');
  const std::string_view place = source.substr(kPrefix.size(), std::min(question, source.size()) - kPrefix.size());

  SimConfig config;
  using Place = SimConfig::Place;
  const Key scene = choice_key("scene", &SimConfig::scene,
                               {{"room", Place::room}, {"corridor", Place::corridor}, {"outdoor", Place::outdoor}});
  if (!scene.set(config, place)) return wrong(std::format("no scene \"{}\"; there is {}", place, scene.wants));
  if (question == source.npos) return config;

  std::vector<Key> keys = all_keys();
  for (const auto part : std::views::split(source.substr(question + 1), '&'))
    if (const auto problem = apply(std::string_view(part), keys, config)) return wrong(*problem);
  return config;
}

}  // namespace pllit
