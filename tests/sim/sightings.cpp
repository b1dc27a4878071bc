#include "pllit/sim/sightings.hpp"

#include <gtest/gtest.h>

namespace pllit {
namespace {

/// A side of a box, a point every 5 mm.
void add_side(Sighting& sighting, float x_m, float width_m, int times) {
  for (int round = 0; round < times; ++round)
    for (float y = 0.0025F; y < width_m; y += 0.005F)
      for (float z = 0.0025F; z < 0.2F; z += 0.005F) sighting.add({x_m, y, z}, 1.0);
}

TEST(Sighting, HasNoCentroidBeforeAnythingWasSeen) { EXPECT_FALSE(Sighting().centroid_O()); }

TEST(Sighting, CountsWhatWasSeenLongNoMoreThanWhatWasSeenOnce) {
  Sighting even, uneven;
  for (Sighting* sighting : {&even, &uneven}) add_side(*sighting, 0.0F, 0.2F, 1);
  add_side(even, 1.0F, 0.2F, 1);
  add_side(uneven, 1.0F, 0.2F, 50);
  EXPECT_LT((*even.centroid_O() - Vector3d(0.5, 0.1, 0.1)).norm(), 1e-3);
  EXPECT_LT((*uneven.centroid_O() - *even.centroid_O()).norm(), 1e-3);
}

TEST(Sighting, LiesOnTheSideThatWasSeen) {
  Sighting sighting;
  add_side(sighting, 0.3F, 0.4F, 2);
  EXPECT_LT((*sighting.centroid_O() - Vector3d(0.3, 0.2, 0.1)).norm(), 1e-3);
}

}  // namespace
}  // namespace pllit
