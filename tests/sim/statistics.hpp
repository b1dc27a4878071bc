// Is this noise of the stated size?
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace pllit::test {

/// Distance of the sum of squares from its expectation, in its own standard deviations, for values that should be
/// standard normal: chi-square with n degrees of freedom has mean n and variance 2n.
inline double chi_square_deviation(const std::vector<double>& normalized) {
  double sum = 0.0;
  for (const double x : normalized) sum += x * x;
  const double n = static_cast<double>(normalized.size());
  return (sum - n) / std::sqrt(2.0 * n);
}

/// Distance of the mean from zero in its own standard deviations.
inline double mean_deviation(const std::vector<double>& normalized) {
  double sum = 0.0;
  for (const double x : normalized) sum += x;
  return sum / std::sqrt(static_cast<double>(normalized.size()));
}

}  // namespace pllit::test
