#include "pllit/map/radiometry.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pllit {
namespace {

constexpr int kColdest_K = 100, kHottest_K = 1500;

/// Planck's law, W/m2/sr/m, with the constants of CODATA 2018.
double spectral_radiance(double wavelength_m, double temperature_K) {
  constexpr double c1L = 1.191042972e-16, c2 = 1.438776877e-2;  // 2 h c^2, W m2/sr; h c / k, m K
  return c1L / (std::pow(wavelength_m, 5) * std::expm1(c2 / (wavelength_m * temperature_K)));
}

/// Gauss and Legendre's rule with four points on each of six parts of the band.
double band_integral(double temperature_K) {
  constexpr double from_m = 8e-6, to_m = 14e-6;
  constexpr int parts = 6;
  constexpr double half_m = (to_m - from_m) / (2 * parts);
  constexpr double nodes[] = {0.3399810435848563, 0.8611363115940526};
  constexpr double weights[] = {0.6521451548625461, 0.3478548451374538};
  double sum = 0.0;
  for (int part = 0; part < parts; ++part) {
    const double middle_m = from_m + (2 * part + 1) * half_m;
    for (int i = 0; i < 2; ++i)
      for (const double side : {-1.0, 1.0})
        sum += weights[i] * half_m * spectral_radiance(middle_m + side * nodes[i] * half_m, temperature_K);
  }
  return sum;
}

}  // namespace

BandRadiance::BandRadiance() {
  for (int kelvin = kColdest_K; kelvin <= kHottest_K; ++kelvin) table_.push_back(band_integral(kelvin));
}

double BandRadiance::of(double temperature_K) const {
  const double place = std::clamp<double>(temperature_K, kColdest_K, kHottest_K) - kColdest_K;
  const std::size_t index = std::min(static_cast<std::size_t>(place), table_.size() - 2);
  return table_[index] + (place - static_cast<double>(index)) * (table_[index + 1] - table_[index]);
}

double BandRadiance::temperature_K(double radiance) const {
  const double within = std::clamp(radiance, table_.front(), table_.back());
  const auto above = std::upper_bound(table_.begin() + 1, table_.end() - 1, within);
  const double share = (within - *std::prev(above)) / (*above - *std::prev(above));
  return kColdest_K + static_cast<double>(above - table_.begin() - 1) + share;
}

double RadiometricEquation::object_K(double apparent_K, double range_m) const {
  const double through = std::exp(-radiometry_.absorbed_per_m * range_m), emits = radiometry_.emissivity;
  const double left = (band_.of(apparent_K) - (1.0 - through) * band_.of(radiometry_.air_K)) / through;
  return band_.temperature_K((left - (1.0 - emits) * band_.of(radiometry_.reflected_K)) / emits);
}

double RadiometricEquation::apparent_K(double object_K, double range_m) const {
  const double through = std::exp(-radiometry_.absorbed_per_m * range_m), emits = radiometry_.emissivity;
  const double leaves = emits * band_.of(object_K) + (1.0 - emits) * band_.of(radiometry_.reflected_K);
  return band_.temperature_K(through * leaves + (1.0 - through) * band_.of(radiometry_.air_K));
}

double RadiometricEquation::with_emissivity(double object_K, double emissivity) const {
  const double reflected = band_.of(radiometry_.reflected_K);
  const double leaves = radiometry_.emissivity * (band_.of(object_K) - reflected) + reflected;
  return band_.temperature_K((leaves - (1.0 - emissivity) * reflected) / emissivity);
}

}  // namespace pllit
