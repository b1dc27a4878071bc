#include "pllit/sim/sequences.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <format>
#include <ranges>
#include <utility>

#include "pllit/sim/config.hpp"

namespace pllit {
namespace {

constexpr std::uint64_t kSeedsPerRow = 1000;

Expected<Sequence> parse_row(const std::string& name, const YAML::Node& row) {
  const auto wrong = [&](const std::string& what) {
    return input_error(std::format("row {} of the sequences: {}", name, what));
  };
  for (const char* key : {"source", "world", "config", "tier"})
    if (!row[key]) return wrong(std::format("{} is missing", key));
  const auto tier = std::ranges::find(kTierNames, row["tier"].as<std::string>());
  if (tier == kTierNames.end()) return wrong("tier is smoke, short or full");
  Sequence sequence{.name = name,
                    .source = row["source"].as<std::string>(),
                    .world = row["world"].as<std::uint64_t>(),
                    .config = row["config"].as<std::string>(),
                    .tier = static_cast<Sequence::Tier>(tier - kTierNames.begin())};
  if (const auto config = parse_sim_config(sequence.address(0)); !config) return wrong(config.error().message);
  return sequence;
}

/// An address with key=value in the place of the key's value, or behind it all.
std::string with_key(std::string_view address, std::string_view assignment) {
  const std::string_view key = assignment.substr(0, std::min(assignment.find('='), assignment.size()));
  const std::size_t question = std::min(address.find('?'), address.size());
  std::string changed(address.substr(0, question));
  char separator = '?';
  const auto add = [&](std::string_view part) { changed += std::exchange(separator, '&') + std::string(part); };
  for (const auto part : std::views::split(address.substr(std::min(question + 1, address.size())), '&'))
    if (const std::string_view old(part); !old.empty() && old.substr(0, old.find('=')) != key) add(old);
  add(assignment);
  return changed;
}

std::optional<std::uint64_t> row_seed(std::string_view text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc{} || end != text.data() + text.size() || seed >= kSeedsPerRow) return std::nullopt;
  return seed;
}

}  // namespace

std::string Sequence::address(std::uint64_t seed) const {
  return std::format("{}&seed={}", source, world * kSeedsPerRow + seed);
}

Expected<std::vector<Sequence>> parse_sequences(std::string_view yaml) try {
  std::vector<Sequence> sequences;
  for (const auto& row : YAML::Load(std::string(yaml))["rows"]) {
    auto sequence = parse_row(row.first.as<std::string>(), row.second);
    if (!sequence) return std::unexpected(sequence.error());
    sequences.push_back(std::move(*sequence));
  }
  return sequences;
} catch (const YAML::Exception& error) {
  return input_error(std::format("the table of sequences: {}", error.what()));
}

std::vector<Sequence> sequences() { return parse_sequences(sequences_yaml()).value_or(std::vector<Sequence>{}); }

Expected<std::string> expanded_address(std::string_view source) {
  const std::size_t question = std::min(source.find('?'), source.size());
  constexpr std::string_view kPrefix = "sim:";
  const auto rows = sequences();
  const auto row =
      source.starts_with(kPrefix)
          ? std::ranges::find(rows, source.substr(kPrefix.size(), question - kPrefix.size()), &Sequence::name)
          : rows.end();
  if (row == rows.end()) return std::string(source);
  std::uint64_t seed = 0;
  Sequence changed = *row;
  for (const auto part : std::views::split(source.substr(std::min(question + 1, source.size())), '&')) {
    const std::string_view assignment(part);
    if (assignment.empty()) continue;
    if (assignment.starts_with("seed=")) {
      const auto given = row_seed(assignment.substr(5));
      if (!given)
        return input_error(std::format("{}: a row's seed is a whole number from 0 to {}", source, kSeedsPerRow - 1));
      seed = *given;
    } else {
      changed.source = with_key(changed.source, assignment);
    }
  }
  return changed.address(seed);
}

}  // namespace pllit
