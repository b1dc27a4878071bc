#include "pllit/loop/descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pllit {
namespace {

constexpr int sectors = 120;
constexpr int rings = PlaceDescriptor::rings, harmonics = PlaceDescriptor::harmonics;
using Image = std::array<std::array<float, sectors>, rings>;
using Complex = std::complex<double>;

/// The height of the tallest column in each sector of each ring, limited so that towers do not outweigh all else.
Image polar_heights(const std::vector<Column>& columns) {
  constexpr int tallest = 8;
  Image image{};
  for (const Column& column : columns) {
    const auto ring = static_cast<std::size_t>(column.centre_H.norm() / PlaceDescriptor::ring_m);
    if (ring >= rings) continue;
    const double turn = std::atan2(column.centre_H.y(), column.centre_H.x()) / (2.0 * M_PI) + 1.0;  // 0.5 to 1.5
    float& cell = image[ring][static_cast<std::size_t>(turn * sectors) % sectors];
    cell = std::max(cell, static_cast<float>(std::min(column.height, tallest)));
  }
  return image;
}

/// Blurs over neighbouring rings, for two visits are rarely in the same spot.
Image over_rings(const Image& image) {
  Image blurred{};
  for (std::size_t r = 0; r < rings; ++r)
    for (std::size_t s = 0; s < sectors; ++s)
      blurred[r][s] = 0.5F * image[r][s] + 0.25F * (r > 0 ? image[r - 1][s] : 0.0F) +
                      0.25F * (r + 1 < rings ? image[r + 1][s] : 0.0F);
  return blurred;
}

/// exp(2 pi i k / sectors)
const std::array<Complex, sectors> roots = [] {
  std::array<Complex, sectors> table;
  for (int k = 0; k < sectors; ++k) table[static_cast<std::size_t>(k)] = std::polar(1.0, 2.0 * M_PI * k / sectors);
  return table;
}();
Complex root(int k) { return roots[static_cast<std::size_t>(k % sectors)]; }

}  // namespace

PlaceDescriptor describe(const std::vector<Column>& columns) {
  const Image image = over_rings(polar_heights(columns));
  double squared = 0.0;
  std::array<std::array<Complex, harmonics>, rings> spectrum{};
  for (std::size_t r = 0; r < rings; ++r)
    for (int k = 0; k < harmonics; ++k) {
      Complex sum = 0.0;
      for (int s = 0; s < sectors; ++s)
        sum += static_cast<double>(image[r][static_cast<std::size_t>(s)]) * std::conj(root((k + 1) * s));
      spectrum[r][static_cast<std::size_t>(k)] = sum;
      squared += std::norm(sum);
    }
  PlaceDescriptor descriptor;
  if (squared > 0.0)
    for (std::size_t r = 0; r < rings; ++r)
      for (std::size_t k = 0; k < harmonics; ++k)
        descriptor.spectrum[r][k] = std::complex<float>(spectrum[r][k] / std::sqrt(squared));
  return descriptor;
}

HeadingMatch align(const PlaceDescriptor& a, const PlaceDescriptor& b) {
  std::array<std::complex<float>, harmonics> product{};
  for (std::size_t r = 0; r < rings; ++r)
    for (std::size_t k = 0; k < harmonics; ++k) {
      const std::complex<float>&p = a.spectrum[r][k], &q = b.spectrum[r][k];  // p conj(q), without the checks for NaN
      product[k] +=
          std::complex<float>(p.real() * q.real() + p.imag() * q.imag(), p.imag() * q.real() - p.real() * q.imag());
    }
  std::array<double, sectors> at{};  // correlation of a(s) with b(s - shift)
  for (int shift = 0; shift < sectors; ++shift)
    for (int k = 0; k < harmonics; ++k)
      at[static_cast<std::size_t>(shift)] +=
          (Complex(product[static_cast<std::size_t>(k)]) * root((k + 1) * shift)).real();
  const auto best = static_cast<int>(std::ranges::max_element(at) - at.begin());
  // The top of the parabola through the best shift and its neighbours.
  const double left = at[static_cast<std::size_t>((best + sectors - 1) % sectors)],
               top = at[static_cast<std::size_t>(best)], right = at[static_cast<std::size_t>((best + 1) % sectors)];
  const double bend = left - 2.0 * top + right;
  const double offset = bend < 0.0 ? std::clamp(0.5 * (left - right) / bend, -0.5, 0.5) : 0.0;
  return {top, std::remainder(2.0 * M_PI * (best + offset) / sectors, 2.0 * M_PI)};
}

}  // namespace pllit
