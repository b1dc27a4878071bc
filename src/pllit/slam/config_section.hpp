// How lists of keys are written: one function a struct, each key's name the member's own.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "pllit/slam/config_keys.hpp"

// A key's name is the token of the member that holds it, so that the two cannot diverge.
#define PLLIT_KEY(member) #member, config.member

namespace pllit {

template <class T>
Key::Value value_at(T& member) {
  return &member;
}
template <class T, std::size_t N>
Key::Value value_at(std::array<T, N>& member) {
  return std::span<T>(member);
}

/// Adds keys to one section of the list.
class Section {
 public:
  explicit Section(KeyList& list, std::string prefix = "") : list_(list), prefix_(std::move(prefix)) {}

  Section section(std::string_view name, std::string_view doc) {
    list_.sections.push_back({prefix_ + std::string(name), std::string(doc)});
    return Section(list_, list_.sections.back().path + ".");
  }

  template <class T>
  void add(std::string_view name, T& member, std::string_view doc, std::string_view unit = "", Limits limits = {}) {
    list_.keys.push_back({prefix_ + std::string(name), value_at(member), std::string(doc), std::string(unit), limits});
  }

  /// true or false.
  void add_switch(std::string_view name, bool& member, std::string_view doc) { choose(name, member, kSwitch, doc); }

  template <class E>
  void choose(std::string_view name, E& member, std::span<const std::string_view> words, std::string_view doc) {
    const Choice choice{words, [&member] { return static_cast<std::size_t>(member); },
                        [&member](std::size_t index) { member = static_cast<E>(index); }};
    list_.keys.push_back({prefix_ + std::string(name), choice, std::string(doc), "", {}});
  }
  /// The first word leaves it open.
  template <class E>
  void choose(std::string_view name, std::optional<E>& member, std::span<const std::string_view> words,
              std::string_view doc) {
    const Choice choice{words, [&member] { return member ? static_cast<std::size_t>(*member) + 1 : 0; },
                        [&member](std::size_t index) {
                          member = index == 0 ? std::optional<E>() : std::optional(static_cast<E>(index - 1));
                        }};
    list_.keys.push_back({prefix_ + std::string(name), choice, std::string(doc), "", {}});
  }

 private:
  static constexpr std::array<std::string_view, 2> kSwitch{"false", "true"};
  KeyList& list_;
  std::string prefix_;
};

void list_thermal(Section section, VisionConfig& config);
void list_features(Section section, VisionConfig& config);
void list_vision(Section section, VisionConfig& config);
/// The keys of advanced.anomalies.
void list_anomalies(Section section, ThermographyConfig& config);
/// The keys of advanced.radiometry.
void list_radiometry(Section section, Radiometry& config);
/// The keys of advanced.loop.
void list_loop(Section section, LoopConfig& config);

}  // namespace pllit
