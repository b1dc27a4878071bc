#include "pllit/map/new_surfaces.hpp"

#include <gtest/gtest.h>

#include "support/box_before_wall.hpp"

namespace pllit {
namespace {

Time at(double seconds) { return Time{} + from_seconds(seconds); }

std::vector<Vector3f> points(bool box) { return test::box_before_wall(box ? std::optional(0.4) : std::nullopt); }

/// A box comes after 20 s; not before 60 s does the camera turn to it and to the wall.
TEST(NewSurfaces, AreComparedWithWhatHasAlwaysStoodWhereNothingAroundIsOlder) {
  SightLog past({.spacing_m = 0.001});
  for (int i = 0; i < 60; ++i) past.add(sight_of(at(i), {0.0, 0.002 * (i % 7), 0.0}, points(i >= 20), past.config()));
  ThermalMap map({});
  std::vector<VoxelKey> seen;
  for (int image = 0; image < 20; ++image) {
    ThermalView view{.time = at(60.0 + 0.1 * image), .viewpoint_W = Vector3d::Zero()};
    const auto show = [&](double x, double y, double z, float grey) {
      view.observations.push_back({.p_W = Vector3d(x, y, z), .pixel_px = {0.0F, 0.0F}, .intensity = grey, .raw = grey});
    };
    for (double z = -0.35; z <= 0.351; z += 0.05) {
      for (double y = -0.35; y <= 0.351; y += 0.05) show(2.0, y, z, 200.0F);
      for (double y = 1.0; y <= 1.501; y += 0.05) show(4.0, y, z, 80.0F);
    }
    seen = map.integrate(view);
  }
  const Sight sight = sight_of(at(62.0), Vector3d::Zero(), points(true), past.config());
  const WatchInput input{.map = map, .seen = seen, .sight = sight, .past = past};
  const Watch watch;
  const WatchConfig config{.surround_deg = 25.0};
  NewSurfaces surfaces(input, watch, config);
  const VoxelKey key = map.key_at({2.0, 0.25, 0.0});
  const ThermalVoxel* voxel = map.find(key);
  ASSERT_TRUE(voxel);
  const auto normal = surfaces.normal(key, *voxel, voxel->first_seen - from_seconds(0.5));
  ASSERT_TRUE(normal);
  EXPECT_NEAR(normal->value, 80.0F, 1.0F);
}

}  // namespace
}  // namespace pllit
