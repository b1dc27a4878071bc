// A place's signature that does not depend on the heading in which it was seen, and that gives the heading between two.
#pragma once

#include <array>
#include <complex>

#include "pllit/loop/submap.hpp"

namespace pllit {

/// The upright structure around a place, as heights on rings around it (2 m wide, to 40 m), each ring by the low
/// frequencies of its angular spectrum, without its mean, which says more about the LiDAR than about the place. A turn
/// only shifts the phases, so two places are compared over all headings by one product of spectra. Of our own design;
/// polar images of heights go back to Scan Context (Kim, Kim, IROS 2018).
struct PlaceDescriptor {
  static constexpr int rings = 20, harmonics = 20;
  static constexpr double ring_m = 2.0;
  /// Harmonics 1, 2, ... of each ring; of unit length over all, or zero where nothing stands.
  std::array<std::array<std::complex<float>, harmonics>, rings> spectrum{};
};

PlaceDescriptor describe(const std::vector<Column>& columns);

struct HeadingMatch {
  double score = 0.0;    ///< correlation at the best heading, -1 to 1
  double yaw_rad = 0.0;  ///< of b's frame in a's: p_a = Rz(yaw) p_b
};

/// The best heading of b in a.
HeadingMatch align(const PlaceDescriptor& a, const PlaceDescriptor& b);

}  // namespace pllit
