// Weights of the uniform cumulative quintic B-spline: how far each of five steps between six controls has been made.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace pllit::quintic {

inline constexpr int kOrder = 6;  // quintic: six controls act on each segment
using Polynomial = std::array<double, kOrder>;

constexpr double factorial(int n) { return n < 2 ? 1.0 : n * factorial(n - 1); }
constexpr double choose(int n, int k) { return factorial(n) / (factorial(k) * factorial(n - k)); }
constexpr double power(double base, int exponent) { return exponent == 0 ? 1.0 : base * power(base, exponent - 1); }

/// Coefficient of u^n in the basis function of control s; Sommer et al., CVPR 2020, equation 7.
constexpr double basis_coefficient(int s, int n) {
  double sum = 0.0;
  for (int l = s; l < kOrder; ++l)
    sum += ((l - s) % 2 ? -1.0 : 1.0) * choose(kOrder, l - s) * power(kOrder - 1 - l, kOrder - 1 - n);
  return choose(kOrder - 1, n) / factorial(kOrder - 1) * sum;
}

/// lambda_j(u): how much of step j has been made at u in [0, 1] of a segment, for j = 1 .. 5.
constexpr std::array<Polynomial, kOrder - 1> cumulative_basis() {
  std::array<Polynomial, kOrder - 1> basis{};
  for (int j = 1; j < kOrder; ++j)
    for (int n = 0; n < kOrder; ++n)
      for (int s = j; s < kOrder; ++s)
        basis[static_cast<std::size_t>(j - 1)][static_cast<std::size_t>(n)] += basis_coefficient(s, n);
  return basis;
}
inline constexpr std::array<Polynomial, kOrder - 1> kCumulativeBasis = cumulative_basis();

struct Weight {
  double value = 0.0, rate = 0.0, acceleration = 0.0;  // per 1, per segment, per segment^2
};

constexpr Weight weight_at(const Polynomial& lambda, double u) {
  Weight w;
  for (std::size_t n = kOrder; n-- > 0;) {  // Horner's scheme for a polynomial and its derivatives
    w.acceleration = w.acceleration * u + 2.0 * w.rate;
    w.rate = w.rate * u + w.value;
    w.value = w.value * u + lambda[n];
  }
  return w;
}

/// Where a time falls among the segments.
struct Place {
  std::size_t segment;  ///< also the first of the six controls that act
  double u;             ///< in [0, 1]
};

/// segments is at least 1; times outside are held at the ends.
constexpr Place place_of(double segments_elapsed, std::size_t segments) {
  const double inside = std::clamp(segments_elapsed, 0.0, static_cast<double>(segments));
  const std::size_t segment = std::min(static_cast<std::size_t>(inside), segments - 1);
  return {segment, inside - static_cast<double>(segment)};
}

}  // namespace pllit::quintic
