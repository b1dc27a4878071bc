// Radiance in the long-wave infrared band against temperature.
#pragma once

#include <vector>

namespace pllit {

/// What a black body radiates between 8 and 14 um (Planck's law, integrated), tabulated over 100 to 1500 K and read
/// linearly; outside, the nearest end counts.
class ThermalBand {
 public:
  ThermalBand();
  /// W/m2/sr.
  float radiance(float temperature_K) const;
  /// W/m2/sr/K.
  float slope(float temperature_K) const { return radiance(temperature_K + 0.5F) - radiance(temperature_K - 0.5F); }

 private:
  std::vector<float> table_;
};

}  // namespace pllit
