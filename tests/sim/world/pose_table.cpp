#include "pllit/sim/world/pose_table.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

/// Shaken by hand: 5 cm and half a radian, up to 4 Hz.
SE3 shaken(Time time) {
  const double t = to_seconds(time), w = 2.0 * std::numbers::pi * 4.0;
  const Vector3d p_W(t + 0.05 * std::sin(w * t), 0.05 * std::cos(0.9 * w * t), 1.5 + 0.05 * std::sin(0.7 * w * t));
  return pose_from(exp_so3(Vector3d(0.5 * std::sin(w * t), 0.5 * std::cos(0.8 * w * t), 2.0 * t)), p_W);
}

TEST(PoseTable, StaysWithinATenthOfAMillimetreAndFiveMicroradiansOfTheMotion) {
  const Time start(std::chrono::milliseconds(1234));
  const Duration length = std::chrono::milliseconds(100);
  const PoseTable table(shaken, start, start + length);
  Random random(1);
  for (int i = 0; i < 5000; ++i) {
    const Time time = start + Duration(static_cast<std::int64_t>(random.uniform() * 1e8));
    const Vector3d direction_L = random.gaussian3().normalized();
    const PoseTable::Placed placed = table.place(time, direction_L);
    const SE3 exact = shaken(time);
    EXPECT_LT((placed.p_W - exact.translation()).norm(), 1e-4);
    EXPECT_LT((placed.direction_W - exact.rotation() * direction_L).norm(), 5e-6);
    EXPECT_NEAR(placed.direction_W.norm(), 1.0, 1e-12);
  }
}

TEST(PoseTable, ReachesFromItsStartToItsEnd) {
  const Time start(std::chrono::milliseconds(50));
  for (const Duration length : {Duration(1), Duration(250'000), Duration(99'999'999)}) {
    const PoseTable table(shaken, start, start + length);
    for (const Time time : {start, start + length})
      EXPECT_LT((table.place(time, Vector3d::UnitX()).p_W - shaken(time).translation()).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace pllit
