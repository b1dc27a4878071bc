// Gentle ground: long low hills, the same for the same seed, everywhere smooth.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace pllit {

struct GroundConfig {
  std::uint64_t seed = 1;
  double relief_m = 3.0;         ///< rms height
  double hill_length_m = 250.0;  ///< from crest to crest, within a third
};

class Ground {
 public:
  explicit Ground(const GroundConfig& config);

  /// Height at (x, y) of W.
  double height_m(const Eigen::Vector2d& position_W) const;
  /// (dz/dx, dz/dy).
  Eigen::Vector2d slope(const Eigen::Vector2d& position_W) const;

 private:
  struct Wave {
    double amplitude_m;
    Eigen::Vector2d wave_number_pm;
    double phase;
  };
  std::array<Wave, 6> waves_;
};

}  // namespace pllit
