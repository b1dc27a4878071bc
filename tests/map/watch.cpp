#include "pllit/map/watch.hpp"

#include <gtest/gtest.h>

namespace pllit {
namespace {

const Vector3d strip_W(3.0, 0.125, 0.125), next_W(3.0, 0.175, 0.125);  // neighbouring voxels of a wall

struct Reading {
  Vector3d p_W;
  float grey;
};

/// Whether the strip is watched after a camera has walked by for nine seconds: ten images a second, each with what
/// `shown` says of it; none where that is empty.
template <class Shown>
bool is_watched(const Shown& shown) {
  ThermalMap map({});
  const SightLog past({});
  Watch watch;
  for (int image = 0; image < 90; ++image) {
    const std::vector<Reading> readings = shown(image);
    if (readings.empty()) continue;
    const Time time{std::chrono::milliseconds(100 * image)};
    ThermalView view{.time = time, .viewpoint_W = Vector3d(0.0, 0.02 * image, 0.0)};
    for (const auto& [p_W, grey] : readings)
      view.observations.push_back({.p_W = p_W, .pixel_px = {0.0F, 0.0F}, .intensity = grey, .raw = grey});
    const auto seen = map.integrate(view);
    const Sight sight = sight_of(time, view.viewpoint_W, {}, past.config());
    watch = watched(std::move(watch), {.map = map, .seen = seen, .sight = sight, .past = past}, {});
  }
  return watch.contains(map.key_at(strip_W));
}

/// The strip shows 100, and 200 from the sixth second on; what is next to it shows one value in six of eight images and
/// the other one in the two that follow.
bool is_watched_beside(float mostly, float at_times) {
  return is_watched([&](int image) {
    return std::vector<Reading>{{strip_W, image < 60 ? 100.0F : 200.0F},
                                {next_W, image / 2 % 4 != 0 ? mostly : at_times}};
  });
}

TEST(Watch, TakesInAKnownSurfaceThatHeatsUp) { EXPECT_TRUE(is_watched_beside(100.0F, 100.0F)); }

TEST(Watch, LeavesAloneWhatHasAlwaysBeenNextToIt) { EXPECT_FALSE(is_watched_beside(200.0F, 200.0F)); }

TEST(Watch, LeavesAloneWhatASeamNextToItShowedAtTimes) { EXPECT_FALSE(is_watched_beside(100.0F, 180.0F)); }

TEST(Watch, IsNotBlindedByASeamOfLittleContrast) { EXPECT_TRUE(is_watched_beside(100.0F, 130.0F)); }

TEST(Watch, DoesNotTakeForHeatWhatChangesWithinOneLook) {
  EXPECT_FALSE(is_watched([](int image) { return std::vector<Reading>{{strip_W, image < 40 ? 100.0F : 200.0F}}; }));
}

}  // namespace
}  // namespace pllit
