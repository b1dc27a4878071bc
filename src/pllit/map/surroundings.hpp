// What a new surface is compared with: the intensities of those around it.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

namespace pllit {

struct Surroundings {
  double median = 0.0;
  double upper = 0.0;   ///< quartile
  double spread = 0.0;  ///< robust standard deviation
};

/// Nothing where there are too few to tell.
inline std::optional<Surroundings> surroundings_of(std::vector<double> values) {
  constexpr std::size_t kFewest = 12;
  constexpr double kQuartilesOfSigma = 1.349;
  if (values.size() < kFewest) return std::nullopt;
  std::ranges::sort(values);
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  return Surroundings{at(0.5), at(0.75), (at(0.75) - at(0.25)) / kQuartilesOfSigma};
}

}  // namespace pllit
