#include "pllit/eval/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pllit {

Statistics statistics_of(std::span<const double> values) {
  if (values.empty()) return {};
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  const auto n = static_cast<double>(sorted.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : sorted) {
    sum += value;
    squares += value * value;
  }
  const double mean = sum / n;
  double deviations = 0.0;
  for (const double value : sorted) deviations += (value - mean) * (value - mean);
  const std::size_t middle = sorted.size() / 2;
  const double median = sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
  return {std::sqrt(squares / n), mean, median, std::sqrt(deviations / n), sorted.back()};
}

}  // namespace pllit
