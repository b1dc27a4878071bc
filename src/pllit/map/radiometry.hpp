// From the temperature that a radiometric camera shows to that of the surface.
#pragma once

#include <vector>

namespace pllit {

/// What stands between the two. As it is by default it changes nothing.
struct Radiometry {
  double emissivity = 1.0;      ///< of the surfaces, 8 to 14 um
  double reflected_K = 293.15;  ///< apparent temperature of what they reflect
  double air_K = 293.15;        ///< between camera and surface
  double absorbed_per_m = 0.0;  ///< by that air: it lets exp(-absorbed_per_m range) through (Beer and Lambert)

  bool corrects() const { return emissivity < 1.0 || absorbed_per_m > 0.0; }
};

/// What a black body radiates between 8 and 14 um: Planck's law, integrated, tabulated over 100 to 1500 K and read
/// linearly. Beyond, the nearest end counts.
class BandRadiance {
 public:
  BandRadiance();
  /// W/m2/sr.
  double of(double temperature_K) const;
  /// The temperature whose radiance it is, K.
  double temperature_K(double radiance) const;

 private:
  std::vector<double> table_;
};

/// The measurement formula of thermography, as makers' manuals give it ("The measurement formula", FLIR, Publ. T559382)
/// and ISO 18434-1 asks for: of the radiance that arrives, W = t e W(object) + t (1 - e) W(reflected) + (1 - t) W(air),
/// with the emissivity e and the transmittance t of the air. Errors of the apparent temperature grow as 1 / e t.
class RadiometricEquation {
 public:
  explicit RadiometricEquation(const Radiometry& radiometry) : radiometry_(radiometry) {}

  /// Temperature, K, of a surface at that range that shows as a black body of `apparent_K`.
  double object_K(double apparent_K, double range_m) const;
  /// What such a surface shows as: the inverse.
  double apparent_K(double object_K, double range_m) const;
  /// A temperature found with the emissivity of the radiometry, as it would be with another one.
  double with_emissivity(double object_K, double emissivity) const;

 private:
  Radiometry radiometry_;
  BandRadiance band_;
};

}  // namespace pllit
