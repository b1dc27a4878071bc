// The table of sequences, bench/sequences.yaml, which travels with the program.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pllit/base/error.hpp"

namespace pllit {

struct Sequence {
  enum class Tier { smoke, short_, full };
  std::string name;
  std::string source;  ///< address without the seed
  std::uint64_t world = 0;
  std::string config;  ///< the estimator's preset
  Tier tier = Tier::short_;

  /// The address for seed N, 0 to 999.
  std::string address(std::uint64_t seed) const;
};

inline constexpr std::array<std::string_view, 3> kTierNames{"smoke", "short", "full"};

/// Input error: a row that is wrong, with its name.
Expected<std::vector<Sequence>> parse_sequences(std::string_view yaml);
/// Those of the table.
std::vector<Sequence> sequences();

/// An address for what a user may write: sim:SCENE?..., sim:ROW or sim:ROW?seed=N. Other keys replace the row's own or
/// are added. Input errors: a seed that a row does not take.
Expected<std::string> expanded_address(std::string_view source);

/// The text of bench/sequences.yaml.
std::string_view sequences_yaml();

}  // namespace pllit
