#include "pllit/map/anomalies.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace pllit {
namespace {

/// Whether an alarm is raised for 3 x 3 voxels of a wall that show 100, and from the sixth second on 160, while a
/// camera walks by; within a few pixels of them the image shows so much less all the time, but for the voxel in their
/// middle.
bool is_alarm(float dip, float dip_in_the_middle) {
  ThermalMap map({});
  const SightLog past({});
  AnomalyDetector detector({});
  for (int image = 0; image < 90; ++image) {
    const Time time{std::chrono::milliseconds(100 * image)};
    ThermalView view{.time = time, .viewpoint_W = Vector3d(0.0, 0.1 * image, 0.0)};
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        const float grey = image < 60 ? 100.0F : 160.0F;
        view.observations.push_back({.p_W = Vector3d(3.0, 0.125 + 0.05 * y, 0.125 + 0.05 * z),
                                     .pixel_px = {0.0F, 0.0F},
                                     .intensity = grey,
                                     .dip = image < 60         ? 0.0F
                                            : y == 0 && z == 0 ? dip_in_the_middle
                                                               : dip,
                                     .raw = grey});
      }
    const auto seen = map.integrate(view);
    const Sight sight = sight_of(time, view.viewpoint_W, {}, past.config());
    detector.update({.map = map, .seen = seen, .sight = sight, .past = past}, view);
  }
  return std::ranges::any_of(detector.anomalies(),
                             [](const Anomaly& anomaly) { return anomaly.confirmed.has_value(); });
}

TEST(Anomalies, AreWhatHasHeatedUp) { EXPECT_TRUE(is_alarm(0.0F, 0.0F)); }

TEST(Anomalies, AreNotWhatMayAllBeAnEdgeThatIsSeenAFewPixelsOff) {
  EXPECT_FALSE(is_alarm(50.0F, 50.0F));
  EXPECT_FALSE(is_alarm(50.0F, 0.0F));  // one voxel is not enough
}

}  // namespace
}  // namespace pllit
