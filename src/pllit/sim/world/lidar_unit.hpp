// What one LiDAR that left the factory measures wrong, always in the same way.
#pragma once

#include <array>
#include <vector>

#include "pllit/geometry/lie.hpp"

namespace pllit {

class Random;
struct Beam;

/// How far units of a model lie apart, standard deviations. Sources beside the numbers in lidar_models.cpp.
struct UnitTolerance {
  double range_m = 0.0;                       ///< of all ranges
  double line_range_m = 0.0, line_rad = 0.0;  ///< of each laser's ranges and of its elevation
  double bend_rad = 0.0;                      ///< of directions, a smooth bend of the whole field of view
};

/// A unit without errors, unless drawn.
struct LidarUnit {
  double range_m = 0.0;                        ///< added to all ranges
  std::vector<double> line_range_m, line_rad;  ///< of each line; empty: none
  /// Of the true direction against the reported one, to the left and upwards: times cosine and sine of the azimuth,
  /// and of twice it. The turning parts of a head that is mounted off its axis are of this kind, and over the narrow
  /// field of a prism scanner it is a shift, a scale and a curvature.
  std::array<Eigen::Vector2d, 4> bend_rad = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                                             Eigen::Vector2d::Zero()};
  /// Where on a returning pulse its time is taken: 0 at its peak, 1 where it reaches half of that.
  double leading_edge = 0.0;

  /// Of a beam's true direction against the reported one: to the left and upwards, rad.
  Eigen::Vector2d aside_rad(const Beam& beam) const;
  /// Added to a range, m.
  double offset_m(const Beam& beam) const;
};

LidarUnit drawn_unit(const UnitTolerance& tolerance, std::size_t lines, Random& random);

/// By how much a surface seen at a slant is measured too near. The beam lights a patch of it, which stretches the
/// returning pulse from sigma_p to sqrt(sigma_p^2 + sigma_d^2): half its height is reached earlier by sqrt(2 ln 2)
/// times the growth, and a unit that times the leading edge sees a part of that. Laconte, Deschenes, Labussiere,
/// Pomerleau, "Lidar Measurement Bias Estimation via Return Waveform Modelling" (ICRA 2019), measured up to 0.2 m.
/// pulse_m: full width at half height, as range; spread_m: standard deviation of the patch's range.
double slant_bias_m(double leading_edge, double pulse_m, double spread_m);

}  // namespace pllit
