#include "pllit/sim/config.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <format>
#include <functional>
#include <initializer_list>
#include <ranges>
#include <system_error>
#include <utility>

#include "pllit/base/words.hpp"
#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

using For = SimKey::For;

template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// One key: how to set it, and what it wants, for the message where that fails.
struct Key : SimKey {
  std::function<bool(SimConfig&, std::string_view)> set;
};

/// A number in a double or an optional one.
template <class Object>
Key number_key(std::string_view name, For scenes, Object access, double low, double high, std::string_view unit) {
  return {{name, std::format("a number of {} from {} to {}", unit, low, high), scenes},
          [=](SimConfig& config, std::string_view text) {
            const auto number = parse_number<double>(text);
            if (!number || !(*number >= low && *number <= high)) return false;
            access(config) = *number;
            return true;
          }};
}

Key count_key(std::string_view name, int SimConfig::* member, int high) {
  return {{name, std::format("a whole number from 0 to {}", high), For::worlds},
          [=](SimConfig& config, std::string_view text) {
            const auto number = parse_number<int>(text);
            if (!number || *number < 0 || *number > high) return false;
            config.*member = *number;
            return true;
          }};
}

Key interval_key(std::string_view name, FaultInterval SimFaults::* member) {
  return {{name, "FROM:TO in seconds since the start, with 0 <= FROM < TO", For::all},
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

Key text_key(std::string_view name, std::string_view wants, std::string SimConfig::* member) {
  return {{name, std::string(wants), For::worlds}, [=](SimConfig& config, std::string_view text) {
            config.*member = text;
            return !text.empty();
          }};
}

template <class Choice>
struct Option {
  std::string_view name;
  Choice value;
};

template <class Choice, class Member>
Key choice_key(std::string_view name, For scenes, Member member, std::initializer_list<Option<Choice>> choices) {
  const std::vector<Option<Choice>> options(choices);
  std::string wants;
  for (const auto& option : options) wants += (wants.empty() ? "" : " or ") + std::string(option.name);
  return {{name, wants, scenes}, [=](SimConfig& config, std::string_view text) {
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

#define PLLIT_FIELD(field) [](SimConfig& c) -> auto& { return c.field; }

std::vector<Key> fault_keys() {
  return {
      interval_key("imu_gap", &SimFaults::imu_gap),
      interval_key("lidar_gap", &SimFaults::lidar_gap),
      interval_key("image_gap", &SimFaults::image_gap),
      interval_key("time_back", &SimFaults::time_back),
      interval_key("duplicates", &SimFaults::duplicates),
      interval_key("imu_nan", &SimFaults::imu_nan),
      interval_key("late_scans", &SimFaults::late_scans),
      interval_key("late_images", &SimFaults::late_images),
      interval_key("swapped_imu", &SimFaults::swapped_imu),
      number_key("late_by", For::all, PLLIT_FIELD(faults.late_by_s), 0.0, 10.0, "seconds"),
      number_key("lost_share", For::all, PLLIT_FIELD(faults.lost_share), 0.0, 0.9, "1"),
      number_key("clock_drift", For::all, PLLIT_FIELD(faults.clock_drift_ppm), -1000.0, 1000.0, "ppm"),
  };
}

std::vector<Key> box_keys() {
  using C = SimConfig;
  return {
      choice_key<C::Carried>("motion", For::boxes, &C::carried,
                             {{"walk", C::Carried::walk}, {"shake", C::Carried::shake}}),
      choice_key<C::BoxLidar>("lidar", For::boxes, &C::box_lidar,
                              {{"ring32", C::BoxLidar::ring32}, {"ring16", C::BoxLidar::ring16}}),
      number_key("imu_rate", For::boxes, PLLIT_FIELD(imu_rate_hz), 10.0, 1000.0, "Hz"),
      number_key("speed", For::boxes, PLLIT_FIELD(speed_mps), 0.1, 3.0, "m/s"),
      choice_key<bool>("accel_unit", For::boxes, &C::accel_in_g, {{"mps2", false}, {"g", true}}),
  };
}

std::vector<Key> world_keys() {
  using C = SimConfig;
  return {
      choice_key<C::RigName>("rig", For::worlds, &C::rig,
                             {{"hilti2022", C::RigName::hilti2022},
                              {"ntu4dradlm", C::RigName::ntu4dradlm},
                              {"inspection", C::RigName::inspection}}),
      text_key("motion", "the path of a TUM file", &C::motion),
      number_key("speedup", For::worlds, PLLIT_FIELD(speedup), 0.25, 4.0, "1"),
      choice_key<C::Way>(
          "way", For::worlds, &C::way,
          {{"as_recorded", C::Way::as_recorded}, {"mirrored", C::Way::mirrored}, {"reversed", C::Way::reversed}}),
      number_key("length", For::worlds, PLLIT_FIELD(length_m), 20.0, 50000.0, "metres"),
      text_key("imu", "the name of an IMU model", &C::imu),
      number_key("image_rate", For::worlds, PLLIT_FIELD(image_rate_hz), 0.5, 60.0, "Hz"),
      choice_key<C::Images>("images", For::worlds, &C::images,
                            {{"none", C::Images::none},
                             {"agc", C::Images::agc},
                             {"counts", C::Images::counts},
                             {"both", C::Images::both}}),
      choice_key<bool>("scans", For::worlds, &C::scans, {{"1", true}, {"0", false}}),
      choice_key<bool>("light", For::worlds, &C::day, {{"day", true}, {"night", false}}),
      choice_key<bool>("bare", For::worlds, &C::bare, {{"0", false}, {"1", true}}),
      count_key("people", &C::people, 30),
      count_key("cars", &C::cars, 30),
      choice_key<C::Finding>("finding", For::worlds, &C::finding,
                             {{"none", C::Finding::none},
                              {"table", C::Finding::table},
                              {"cabinet", C::Finding::cabinet},
                              {"pipe", C::Finding::pipe}}),
      choice_key<C::Arrival>(
          "arrival", For::worlds, &C::arrival,
          {{"drawn", C::Arrival::drawn}, {"heated", C::Arrival::heated}, {"brought", C::Arrival::brought}}),
      number_key("finding_at", For::worlds, PLLIT_FIELD(finding_at_s), 0.0, 36000.0, "seconds"),
      number_key("finding_K", For::worlds, PLLIT_FIELD(finding_K), 0.5, 300.0, "kelvin"),
      count_key("hot_boxes", &C::hot_boxes, 30),
      count_key("visit", &C::visit, 1000),
      number_key("warmer_K", For::worlds, PLLIT_FIELD(warmer_K), -60.0, 60.0, "kelvin"),
      number_key("air_drift", For::worlds, PLLIT_FIELD(air_drift_Kph), -300.0, 300.0, "kelvin an hour"),
  };
}

std::vector<Key> all_keys() {
  using C = SimConfig;
  std::vector<Key> keys{
      {{"seed", "a whole number from 0 to 18446744073709551615", For::all}, set_seed},
      number_key("duration", For::all, PLLIT_FIELD(duration_s), 3.0, 36000.0, "seconds"),
      choice_key<bool>("ideal", For::all, &C::ideal, {{"0", false}, {"1", true}}),
  };
  for (auto more : {box_keys(), world_keys(), fault_keys()}) std::ranges::move(more, std::back_inserter(keys));
  return keys;
}

#undef PLLIT_FIELD

constexpr std::array<std::pair<std::string_view, SceneKind>, 9> kScenes{{{"room", SceneKind::room},
                                                                         {"corridor", SceneKind::corridor},
                                                                         {"stairs", SceneKind::stairs},
                                                                         {"plant", SceneKind::plant},
                                                                         {"street", SceneKind::street},
                                                                         {"field", SceneKind::field},
                                                                         {"box_room", SceneKind::box_room},
                                                                         {"box_corridor", SceneKind::box_corridor},
                                                                         {"box_street", SceneKind::box_street}}};

template <class Names>
std::string joined(const Names& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

bool serves(const Key& key, SceneKind scene) {
  return key.scenes == For::all || (key.scenes == For::boxes) == is_box(scene);
}

std::string unknown_key(std::string_view name, SceneKind scene, const std::vector<Key>& keys) {
  std::vector<std::string> serving;
  for (const Key& key : keys)
    if (serves(key, scene)) serving.emplace_back(key.name);
  if (std::ranges::contains(keys, name, &Key::name))
    return std::format("{} does not go with {}; its keys are {}", name, name_of(scene), joined(serving));
  return std::format("\"{}\" is unknown or given twice; did you mean {}? The keys left are {}", name,
                     nearest_word(name, serving), joined(serving));
}

/// What is wrong with `assignment` (key=value), or nothing after it has been applied and its key taken off `keys`.
std::optional<std::string> apply(std::string_view assignment, std::vector<Key>& keys, SimConfig& config) {
  const std::size_t equals = assignment.find('=');
  if (equals == assignment.npos) return std::format("\"{}\" is not of the form key=value", assignment);
  const std::string_view name = assignment.substr(0, equals), value = assignment.substr(equals + 1);
  const auto key = std::ranges::find_if(keys, [&](const Key& k) { return k.name == name && serves(k, config.scene); });
  if (key == keys.end()) return unknown_key(name, config.scene, keys);
  if (!key->set(config, value)) return std::format("{}={}: {} wants {}", name, value, name, key->wants);
  keys.erase(key);
  return std::nullopt;
}

/// What cannot be together, though each value is right.
std::optional<std::string> contradiction(const SimConfig& config) {
  const bool inside = config.scene == SceneKind::room || config.scene == SceneKind::plant;
  if ((config.finding != SimConfig::Finding::none || config.hot_boxes > 0) && !inside)
    return std::format("finding= and hot_boxes= need a room or a plant, not a {}", name_of(config.scene));
  if (config.finding != SimConfig::Finding::none && config.duration_s && config.finding_at_s >= *config.duration_s)
    return std::format("finding_at={} lies beyond duration={}", config.finding_at_s, *config.duration_s);
  if (config.bare && config.scene != SceneKind::corridor) return "bare= needs a corridor";
  if (config.cars > 0 && config.scene != SceneKind::street) return "cars= needs a street";
  if (config.visit > 0 && !(inside && config.motion.empty()))
    return "visit= needs a room or a plant, and no motion=FILE: it is another walk of the inspection's lane";
  if (config.motion.empty() && config.way != SimConfig::Way::as_recorded) return "way= needs motion=FILE";
  if (config.motion.empty() && config.speedup != 1.0) return "speedup= needs motion=FILE";
  return std::nullopt;
}

}  // namespace

std::uint64_t visit_seed(const SimConfig& config) {
  return config.visit == 0 ? config.seed : Random(config.seed, 5000 + static_cast<std::uint64_t>(config.visit)).bits();
}

bool is_box(SceneKind scene) {
  return scene == SceneKind::box_room || scene == SceneKind::box_corridor || scene == SceneKind::box_street;
}

std::string_view name_of(SceneKind scene) {
  return std::ranges::find(kScenes, scene, [](const auto& entry) { return entry.second; })->first;
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& [name, scene] : kScenes) names.emplace_back(name);
  return names;
}

std::vector<SimKey> sim_keys() {
  std::vector<SimKey> keys;
  for (const Key& key : all_keys()) keys.push_back(key);
  return keys;
}

Expected<SimConfig> parse_sim_config(std::string_view source) {
  const auto wrong = [&](const std::string& what) {
    return input_error(std::format("simulation \"{}\": {}", source, what));
  };
  constexpr std::string_view kPrefix = "sim:";
  if (!source.starts_with(kPrefix)) return wrong("it must start with sim:, as in sim:room?seed=3&duration=30");
  const std::size_t question = source.find('?');
  const std::string_view name = source.substr(kPrefix.size(), std::min(question, source.size()) - kPrefix.size());
  const auto scene = std::ranges::find(kScenes, name, [](const auto& entry) { return entry.first; });
  if (scene == kScenes.end())
    return wrong(std::format("no scene \"{}\"; did you mean {}? There is {}", name, nearest_word(name, scene_names()),
                             joined(scene_names())));

  SimConfig config;
  config.scene = scene->second;
  std::vector<Key> keys = all_keys();
  if (question != source.npos)
    for (const auto part : std::views::split(source.substr(question + 1), '&'))
      if (const auto problem = apply(std::string_view(part), keys, config)) return wrong(*problem);
  if (const auto problem = contradiction(config)) return wrong(*problem);
  return config;
}

}  // namespace pllit
