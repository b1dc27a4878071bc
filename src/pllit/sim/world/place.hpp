// A place to simulate in: its surfaces, its tiles, made where they are needed, and what moves in it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pllit/sim/world/mesh.hpp"

namespace pllit {

struct Tile {
  Eigen::Vector3d origin_W = Eigen::Vector3d::Zero();
  Mesh mesh;  ///< vertices relative to origin_W, axes as W
};

/// Light, air and weather, the same everywhere in a place.
struct Climate {
  double air_K = 293.15;
  double air_drift_Kph = 0.0;                           ///< K per hour, steady
  double air_swing_K = 0.0;                             ///< amplitude of a swing over a day
  double sky_K = 263.15;                                ///< effective temperature of the zenith in the thermal band
  Eigen::Vector3d to_sun_W = Eigen::Vector3d::UnitZ();  ///< unit
  double sun = 0.0;                                     ///< direct light, 0 (night, indoors) to 1
  double ambient_light = 0.6;                           ///< light from everywhere, 0 (dark) to 1
};

/// Made from a seed around a motion, so that the motion never meets a wall. The same arguments give the same place; a
/// tile depends on the place and its index alone, whatever was made before.
class Place {
 public:
  virtual ~Place() = default;

  virtual const std::vector<Surface>& surfaces() const = 0;
  virtual const std::vector<Actor>& actors() const = 0;
  virtual const Climate& climate() const = 0;

  /// Indices, ascending, of the tiles with anything within radius_m of a point.
  virtual std::vector<std::uint32_t> tiles_near(const Eigen::Vector3d& p_W, double radius_m) const = 0;
  virtual Tile tile(std::uint32_t index) const = 0;
};

}  // namespace pllit
