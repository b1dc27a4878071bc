// Random numbers that are the same with every standard library: the simulator's results depend on the seed alone.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace pllit {

/// SplitMix64 (Steele, Lea, Flood: "Fast splittable pseudorandom number generators", OOPSLA 2014) with the Box-Muller
/// transform. Each (seed, stream) pair is a sequence of its own, so that what one consumer draws, or does not draw,
/// never changes another's numbers.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(mixed(seed + mixed(stream + kStep))) {}

  std::uint64_t bits() { return mixed(state_ += kStep); }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Standard normal.
  double gaussian() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log1p(-uniform()));
    const double angle = 2.0 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }
  Eigen::Vector3d gaussian3() {
    const double x = gaussian(), y = gaussian(), z = gaussian();
    return {x, y, z};
  }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15;

  static constexpr std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// Approximately normal, unit variance, within +-4.9: the sum of eight 16-bit uniform numbers (Irwin-Hall), six times
/// as fast as the exact transform.
inline float quick_gaussian(Random& random) {
  std::uint32_t sum = 0;
  for (int word = 0; word < 2; ++word) {
    const std::uint64_t bits = random.bits();
    for (int shift = 0; shift < 64; shift += 16) sum += static_cast<std::uint32_t>(bits >> shift) & 0xffffU;
  }
  constexpr float mean = 8.0F * 32767.5F, inverse_sigma = 1.0F / 53509.96F;  // sqrt(8 (2^32 - 1) / 12)
  return (static_cast<float>(sum) - mean) * inverse_sigma;
}

/// Uniform in [low, high), as meshes hold their numbers.
inline float between(Random& random, double low, double high) { return static_cast<float>(random.uniform(low, high)); }

}  // namespace pllit
