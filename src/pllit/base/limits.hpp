// Bounds of a setting.
#pragma once

#include <limits>

namespace pllit {

/// Inclusive bounds of a number, or of every number of a list.
struct Limits {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

}  // namespace pllit
