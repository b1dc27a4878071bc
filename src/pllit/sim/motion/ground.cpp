#include "pllit/sim/motion/ground.hpp"

#include <cmath>
#include <numbers>

#include "pllit/sim/random.hpp"

namespace pllit {

Ground::Ground(const GroundConfig& config) {
  Random random(config.seed, 50);
  const double amplitude_m = config.relief_m * std::sqrt(2.0 / static_cast<double>(waves_.size()));
  for (std::size_t i = 0; i < waves_.size(); ++i) {
    // Directions spread over the half circle, so that no seed gives furrows.
    const double direction =
        std::numbers::pi * (static_cast<double>(i) + random.uniform()) / static_cast<double>(waves_.size());
    const double number_pm = 2.0 * std::numbers::pi / (config.hill_length_m * random.uniform(0.67, 1.33));
    waves_[i] = {amplitude_m, number_pm * Eigen::Vector2d(std::cos(direction), std::sin(direction)),
                 random.uniform(0.0, 2.0 * std::numbers::pi)};
  }
}

double Ground::height_m(const Eigen::Vector2d& position_W) const {
  double height_m = 0.0;
  for (const Wave& wave : waves_)
    height_m += wave.amplitude_m * std::sin(wave.wave_number_pm.dot(position_W) + wave.phase);
  return height_m;
}

Eigen::Vector2d Ground::slope(const Eigen::Vector2d& position_W) const {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (const Wave& wave : waves_)
    slope += wave.amplitude_m * std::cos(wave.wave_number_pm.dot(position_W) + wave.phase) * wave.wave_number_pm;
  return slope;
}

}  // namespace pllit
