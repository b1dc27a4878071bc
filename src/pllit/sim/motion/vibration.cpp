#include "pllit/sim/motion/vibration.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

#include "pllit/sim/motion/quintic_basis.hpp"
#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

constexpr int kWavesPerBand = 5;
constexpr double kTwoPi = 2.0 * std::numbers::pi;

}  // namespace

VibrationConfig hand_held_vibration(std::uint64_t seed) {
  return {.seed = seed,
          .full_speed_mps = 0.5,
          .bands = {{.low_hz = 5.0, .high_hz = 15.0, .acceleration_mps2 = 0.5, .angular_rate_rps = 0.06},
                    {.low_hz = 15.0, .high_hz = 40.0, .acceleration_mps2 = 0.25, .angular_rate_rps = 0.02}}};
}

VibrationConfig vehicle_vibration(std::uint64_t seed) {
  return {.seed = seed,
          .full_speed_mps = 8.0,
          .bands = {{.low_hz = 5.0, .high_hz = 25.0, .acceleration_mps2 = 0.5, .angular_rate_rps = 0.015},
                    {.low_hz = 25.0, .high_hz = 80.0, .acceleration_mps2 = 0.4, .angular_rate_rps = 0.01}}};
}

Vibration::Vibration(const VibrationConfig& config, double spacing_s, const std::vector<double>& speeds_mps)
    : spacing_s_(spacing_s) {
  assert(spacing_s > 0.0 && !speeds_mps.empty() && config.full_speed_mps > 0.0);
  // Control i acts from (i - 5) spacings on; five zeros in front keep what a speed causes behind it.
  strengths_.assign(5, 0.0);
  for (const double speed : speeds_mps) strengths_.push_back(speed / std::hypot(speed, config.full_speed_mps));

  Random random(config.seed, 40);
  for (const VibrationBand& band : config.bands) {
    for (std::size_t axis = 0; axis < waves_.size(); ++axis) {
      for (int i = 0; i < kWavesPerBand; ++i) {
        const double share = (i + random.uniform()) / kWavesPerBand;
        const double omega_rps = kTwoPi * band.low_hz * std::pow(band.high_hz / band.low_hz, share);
        // A sine of amplitude a has the rms a / sqrt 2, its derivative omega times that.
        const double rms =
            axis < 3 ? band.acceleration_mps2 / (omega_rps * omega_rps) : band.angular_rate_rps / omega_rps;
        waves_[axis].push_back({rms * std::sqrt(2.0 / kWavesPerBand), omega_rps, random.uniform(0.0, kTwoPi)});
      }
    }
  }
}

Vibration::Strength Vibration::strength_at(double t_s) const {
  const auto [segment, u] = quintic::place_of(t_s / spacing_s_, strengths_.size() - 5);
  Strength strength{strengths_[segment], 0.0, 0.0};
  for (std::size_t j = 0; j < quintic::kCumulativeBasis.size(); ++j) {
    const quintic::Weight w = quintic::weight_at(quintic::kCumulativeBasis[j], u);
    const double step = strengths_[segment + j + 1] - strengths_[segment + j];
    strength.value += w.value * step;
    strength.rate += w.rate / spacing_s_ * step;
    strength.acceleration += w.acceleration / (spacing_s_ * spacing_s_) * step;
  }
  return strength;
}

VibrationState Vibration::at(double t_s) const {
  const Strength strength = strength_at(t_s);
  Eigen::Matrix<double, 6, 1> value, rate, acceleration;
  for (std::size_t axis = 0; axis < waves_.size(); ++axis) {
    double x = 0.0, x_dot = 0.0, x_ddot = 0.0;
    for (const Wave& wave : waves_[axis]) {
      const double angle = wave.omega_rps * t_s + wave.phase;
      const double sine = wave.amplitude * std::sin(angle);
      x += sine;
      x_dot += wave.amplitude * wave.omega_rps * std::cos(angle);
      x_ddot -= wave.omega_rps * wave.omega_rps * sine;
    }
    const auto row = static_cast<Eigen::Index>(axis);
    value[row] = strength.value * x;
    rate[row] = strength.rate * x + strength.value * x_dot;
    acceleration[row] = strength.acceleration * x + 2.0 * strength.rate * x_dot + strength.value * x_ddot;
  }
  return {value.head<3>(), rate.head<3>(), acceleration.head<3>(), value.tail<3>(), rate.tail<3>()};
}

}  // namespace pllit
