// What robust fits of curves share.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace pllit {

/// Tukey's biweight: 1 at zero, falling to 0 at `width` and beyond.
inline double tukey_weight(double residual, double width) {
  const double u = residual / width;
  return std::abs(u) < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
}

/// The median of the slopes between all pairs of points (x, y) whose x differ: Theil 1950, Sen 1968. Up to 29 % of the
/// points may be anywhere. Nothing where no two x differ.
inline std::optional<double> theil_sen_slope(std::span<const std::pair<double, double>> points) {
  std::vector<double> slopes;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      if (const double dx = points[j].first - points[i].first; dx != 0.0)
        slopes.push_back((points[j].second - points[i].second) / dx);
  if (slopes.empty()) return std::nullopt;
  std::ranges::sort(slopes);
  const std::size_t half = slopes.size() / 2;
  return slopes.size() % 2 == 1 ? slopes[half] : 0.5 * (slopes[half - 1] + slopes[half]);
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
