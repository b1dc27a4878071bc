// A made-up site for tests of what recognises places.
#pragma once

#include <cmath>
#include <vector>

#include "support/random_states.hpp"

namespace pllit::test {

/// Walls and sheds on a plain, forty metres square, the same for the same seed.
inline std::vector<Vector3f> walled_site(unsigned seed, Random& noise) {
  Random random(seed);
  std::vector<Vector3f> points;
  const auto add = [&](double x, double y, double z) {
    points.emplace_back(static_cast<float>(x + noise.normal(0.01)), static_cast<float>(y + noise.normal(0.01)),
                        static_cast<float>(z + noise.normal(0.01)));
  };
  for (int i = 0; i < 20000; ++i) add(noise.uniform(-20.0, 20.0), noise.uniform(-20.0, 20.0), 0.0);
  for (int wall = 0; wall < 30; ++wall) {
    const double x = random.uniform(-18.0, 18.0), y = random.uniform(-18.0, 18.0), turn = random.uniform(0.0, 6.3),
                 length = random.uniform(2.0, 7.0), height = random.uniform(2.0, 5.0);
    for (int i = 0; i < 1500; ++i) {
      const double s = noise.uniform(0.0, length);
      add(x + s * std::cos(turn), y + s * std::sin(turn), noise.uniform(0.0, height));
    }
  }
  return points;
}

}  // namespace pllit::test
