// The way up a stairwell, and the steps under it; for stairs.cpp.
#pragma once

#include <utility>
#include <vector>

#include "pllit/sim/places/scene.hpp"

namespace pllit::stairs {

inline constexpr double kStep_m = 0.1;  ///< between stations along the path
inline constexpr float kSlab_m = 0.16F;

struct Station {
  Eigen::Vector2d p;
  Eigen::Vector2d left;  ///< unit, at a right angle to the way
  double ground_z;
};

/// The way on the ground at even horizontal spacing, with smoothed heights: standing still or bobbing adds nothing.
std::vector<Station> stations_of(const Site& site);

/// Heights of the steps: a station's tread is at a whole number of rises; landings are as high as the way is there.
std::vector<double> treads_of(const std::vector<Station>& way);

/// The stations of the flights and their landings, first and last: from a little before the first rise to a little
/// after the last.
std::pair<std::size_t, std::size_t> climb_of(const std::vector<Station>& way);

/// Steps, slabs and railings along the way.
void add_way(const std::vector<Station>& way, const std::vector<double>& treads, const Site& site, SceneBuilder& scene);

inline Eigen::Vector3f point(const Eigen::Vector2d& p, double z) {
  return Eigen::Vector3d(p.x(), p.y(), z).cast<float>();
}

}  // namespace pllit::stairs
