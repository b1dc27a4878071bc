#include "pllit/map/watch.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <optional>

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
bool is_watched(const Shown& shown, const Vector3d& place_W = strip_W, const WatchConfig& config = {}) {
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
    watch = watched(std::move(watch), {.map = map, .seen = seen, .sight = sight, .past = past}, config);
  }
  return watch.contains(map.key_at(place_W));
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

/// The same strip; the voxel next to it is seen in some images only.
bool is_part(bool whole_things, const std::function<std::optional<float>(int image)>& next, float hot = 200.0F) {
  const WatchConfig config{.seam_voxels = 0, .bent_curves = false, .whole_things = whole_things, .part_share = 0.5};
  return is_watched(
      [&](int image) {
        std::vector<Reading> readings{{strip_W, image < 60 ? 100.0F : hot}};
        if (const auto grey = next(image)) readings.push_back({next_W, *grey});
        return readings;
      },
      next_W, config);
}

TEST(Watch, TakesInWhatHangsTogetherWithHeatAndCameIntoSightSince) {
  const auto later = [](int image) { return image == 75 ? std::optional(190.0F) : std::nullopt; };
  EXPECT_TRUE(is_part(true, later)) << "one image of it";
  EXPECT_FALSE(is_part(false, later)) << "not where greys are all there is";
}

TEST(Watch, TakesInWhatWasSeenBeforeTheHeatNextToItWasSure) {
  EXPECT_TRUE(is_part(true, [](int image) { return image == 60 ? std::optional(190.0F) : std::nullopt; }));
}

TEST(Watch, TakesInNoPartThatHasAlwaysBeenHotNextToIt) {
  EXPECT_FALSE(is_part(true, [](int) { return std::optional(190.0F); }));
}

TEST(Watch, TakesInNoPartThatIsHardlyWarm) {
  EXPECT_FALSE(is_part(true, [](int image) { return std::optional(image < 60 ? 100.0F : 110.0F); }));
}

TEST(Watch, TakesInAPartThatIsHotByLessThanCountsAlone) {
  const auto next = [](int image) { return std::optional(image < 60 ? 100.0F : 128.0F); };
  EXPECT_TRUE(is_part(true, next, 150.0F));
  EXPECT_FALSE(is_part(false, next, 150.0F));
  EXPECT_FALSE(is_part(true, next, 200.0F)) << "less than half as hot as what it is next to";
}

/// Whether what shows `third` where it comes into sight, beyond a part of the strip's heat, is one as well.
bool is_part_of_a_part(float third) {
  const Vector3d third_W(3.0, 0.225, 0.125);
  const WatchConfig config{.seam_voxels = 0, .bent_curves = false, .whole_things = true, .part_share = 0.5};
  return is_watched(
      [&](int image) {
        std::vector<Reading> readings{{strip_W, image < 60 ? 100.0F : 300.0F}};
        if (image >= 75) readings.insert(readings.end(), {{next_W, 210.0F}, {third_W, third}});
        return readings;
      },
      third_W, config);
}

TEST(Watch, DoesNotFollowHeatThatHalvesFromPartToPart) {
  EXPECT_TRUE(is_part_of_a_part(205.0F));
  EXPECT_FALSE(is_part_of_a_part(170.0F)) << "over half as hot as the part beside it, but not as the strip";
}

TEST(Watch, LetsOneVoxelVouchForFewOthersOnly) {
  // A wall as hot as the strip comes into sight beside it, as one that was always hot would where nobody had looked.
  const auto far_W = [](int columns) { return Vector3d(strip_W + 0.05 * Vector3d(0.0, columns, 0.0)); };
  const auto is_taken_in = [&](int columns) {
    const WatchConfig config{
        .seam_voxels = 0, .bent_curves = false, .whole_things = true, .part_voxels = 1, .parts_of_one = 5};
    return is_watched(
        [&](int image) {
          std::vector<Reading> readings{{strip_W, image < 60 ? 100.0F : 200.0F}};
          for (int column = 1; image >= 75 && column <= 30; ++column) readings.push_back({far_W(column), 200.0F});
          return readings;
        },
        far_W(columns), config);
  };
  EXPECT_TRUE(is_taken_in(5));
  EXPECT_FALSE(is_taken_in(25));
}

/// A wall of which all shows 100, and `later` from the sixth second on, but for the strip, which shows 140 then.
bool is_watched_on_a_wall(float later) {
  return is_watched([&](int image) {
    std::vector<Reading> readings{{strip_W, image < 60 ? 100.0F : 140.0F}};
    for (int y = -4; y <= 4; ++y)
      for (int z = -4; z <= 4; ++z)
        if (std::abs(y) > 1 || std::abs(z) > 1)
          readings.push_back({strip_W + 0.05 * Vector3d(0.0, y, z), image < 60 ? 100.0F : later});
    return readings;
  });
}

TEST(Watch, TakesInAStripThatHeatsUpOnAWall) { EXPECT_TRUE(is_watched_on_a_wall(100.0F)); }

TEST(Watch, DoesNotTakeForHeatWhatChangesWithAllAroundIt) { EXPECT_FALSE(is_watched_on_a_wall(125.0F)); }

/// A dark door in a brighter room: 7 x 7 voxels show 20, all others 120; from the sixth second on the strip shows 60,
/// and the rest of the door `later`.
bool is_watched_in_the_dark(float later) {
  return is_watched([&](int image) {
    std::vector<Reading> readings;
    for (int y = -12; y <= 12; ++y)
      for (int z = -12; z <= 12; ++z) {
        const bool door = std::abs(y) <= 3 && std::abs(z) <= 3, strip = y == 0 && z == 0;
        const float grey = !door ? 120.0F : image < 60 ? 20.0F : strip ? 60.0F : later;
        readings.push_back({strip_W + 0.05 * Vector3d(0.0, y, z), grey});
      }
    return readings;
  });
}

TEST(Watch, TakesInHeatAmongTheDarkestSurfaces) { EXPECT_TRUE(is_watched_in_the_dark(20.0F)); }

TEST(Watch, DoesNotTakeForHeatWhatAllTheDarkestSurfacesShow) { EXPECT_FALSE(is_watched_in_the_dark(60.0F)); }

TEST(Watch, DoesNotLetAnotherSideOfTheSameHeatExplainIt) {
  // Known until the fourth second; when the rig is back it sees the heat from the other side first.
  EXPECT_TRUE(is_watched([](int image) {
    if (image < 40) return std::vector<Reading>{{strip_W, 100.0F}};
    if (image < 60) return std::vector<Reading>{};
    if (image < 65) return std::vector<Reading>{{next_W, 200.0F}};
    return std::vector<Reading>{{strip_W, 200.0F}, {next_W, 200.0F}};
  }));
}

TEST(Watch, DoesNotTakeForHeatWhatChangesWithinOneLook) {
  EXPECT_FALSE(is_watched([](int image) { return std::vector<Reading>{{strip_W, image < 40 ? 100.0F : 200.0F}}; }));
}

TEST(Watch, KnowsAgainWhatACoarseSightHadMissed) {
  ThermalMap map({});
  const SightLog past({});
  Watch watch{{map.key_at(strip_W),
               {.new_surface = true, .hot = true, .normal = 100.0F, .sigma = 6.0F, .owner = 1, .position_W = strip_W}}};
  const auto look = [&](int image, double wall_m) {
    const Time time{std::chrono::milliseconds(100 * image)};
    const ThermalView view{
        .time = time, .observations = {{.p_W = strip_W, .pixel_px = {0.0F, 0.0F}, .intensity = 200.0F, .raw = 200.0F}}};
    std::vector<Vector3f> wall_W;
    for (float y = -1.0F; y <= 1.0F; y += 0.02F)
      for (float z = -1.0F; z <= 1.0F; z += 0.02F) wall_W.emplace_back(wall_m, y, z);
    const auto seen = map.integrate(view);
    const Sight sight = sight_of(time, Vector3d::Zero(), wall_W, past.config());
    watch = watched(std::move(watch), {.map = map, .seen = seen, .sight = sight, .past = past}, {});
    return watch.begin()->second;
  };
  EXPECT_TRUE(look(1, 3.0).hot);
  look(2, 5.0);
  EXPECT_TRUE(look(3, 5.0).vacated) << "two scans saw through it";
  EXPECT_FALSE(look(4, 5.0).hot);
  EXPECT_FALSE(look(5, 3.0).vacated) << "there is a surface again, as hot";
  EXPECT_TRUE(look(6, 3.0).hot);
}

}  // namespace
}  // namespace pllit
