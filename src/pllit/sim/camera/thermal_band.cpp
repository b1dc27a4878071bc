#include "pllit/sim/camera/thermal_band.hpp"

#include <algorithm>
#include <cmath>

namespace pllit {
namespace {

constexpr int kLowest_K = 100, kHighest_K = 1500;

/// Planck's spectral radiance, W/m2/sr/m.
double planck(double wavelength_m, double temperature_K) {
  constexpr double c1 = 1.191042972e-16, c2 = 1.438776877e-2;  // 2hc^2 in W m2/sr, hc/k in m K
  return c1 / (std::pow(wavelength_m, 5) * std::expm1(c2 / (wavelength_m * temperature_K)));
}

/// Simpson's rule over the band.
double integral(double temperature_K) {
  constexpr double from_m = 8e-6, to_m = 14e-6;
  constexpr int steps = 24;
  constexpr double h_m = (to_m - from_m) / steps;
  double sum = planck(from_m, temperature_K) + planck(to_m, temperature_K);
  for (int i = 1; i < steps; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * planck(from_m + i * h_m, temperature_K);
  return sum * h_m / 3.0;
}

}  // namespace

ThermalBand::ThermalBand() {
  for (int kelvin = kLowest_K; kelvin <= kHighest_K; ++kelvin) table_.push_back(static_cast<float>(integral(kelvin)));
}

float ThermalBand::radiance(float temperature_K) const {
  const float place = std::clamp(temperature_K, 100.0F, 1499.99F) - static_cast<float>(kLowest_K);
  const auto index = static_cast<std::size_t>(place);
  return table_[index] + (place - static_cast<float>(index)) * (table_[index + 1] - table_[index]);
}

}  // namespace pllit
