// What robust fits of curves share.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

namespace pllit {

/// Tukey's biweight: 1 at zero, falling to 0 at `width` and beyond.
inline double tukey_weight(double residual, double width) {
  const double u = residual / width;
  return std::abs(u) < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
}

/// Where a value lies between knots: weight 1 - s on `left`, s on the one behind it; at an end for values beyond it.
struct OnKnots {
  std::size_t left;
  double s;
};

/// `knots` ascend, two at least.
inline OnKnots on_knots(const std::vector<double>& knots, double value) {
  const auto after = std::ranges::upper_bound(knots, value) - knots.begin();
  const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after, 1, std::ssize(knots) - 1));
  return {i - 1, std::clamp((value - knots[i - 1]) / (knots[i] - knots[i - 1]), 0.0, 1.0)};
}

}  // namespace pllit
