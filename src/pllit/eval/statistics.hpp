// Figures that sum up a list of errors, as evo defines them.
#pragma once

#include <span>

namespace pllit {

/// `std` is that of the population (divided by n); the median of an even number is the mean of the middle two. All zero
/// for no values.
struct Statistics {
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double std = 0.0;
  double max = 0.0;
};

Statistics statistics_of(std::span<const double> values);

}  // namespace pllit
