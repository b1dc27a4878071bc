#include "pllit/map/thermal_voxel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

/// A voxel that is shown images, ten a second.
struct Shown {
  VoxelModelConfig config{.noise = 4.0, .min_change = 20.0};
  ThermalVoxel voxel{};
  Time time{};

  void show(VoxelSample sample) {
    time += std::chrono::milliseconds(100);
    sample.time = time;
    sample.viewpoint_W = Vector3f(static_cast<float>(0.1 * to_seconds(time)), 0.0F, 0.0F);
    sample.offset_m = Vector3f::Zero();
    voxel = seen(voxel, sample, config);
  }
  void operator()(double intensity, double saturated = 0.0, double spread = 0.0, double doubt = 0.0) {
    show({.time = {},
          .viewpoint_W = {},
          .offset_m = {},
          .intensity = static_cast<float>(intensity),
          .doubt = static_cast<float>(doubt),
          .saturated = static_cast<float>(saturated),
          .spread = static_cast<float>(spread)});
  }
  /// Beside an edge of the image.
  void beside(double intensity, double dip, double rise) {
    show({.time = {},
          .viewpoint_W = {},
          .offset_m = {},
          .intensity = static_cast<float>(intensity),
          .dip = static_cast<float>(dip),
          .rise = static_cast<float>(rise)});
  }
  void noisy(Random& random, double mean, double sigma, int images) {
    for (int i = 0; i < images; ++i) (*this)(mean + random.normal(sigma));
  }
};

TEST(ThermalVoxel, LearnsMeanAndSpreadAsOneWouldFromAllImagesAtOnce) {
  Random random(1);
  Shown shown{.config = {.noise = 0.01, .learned_views = 1}, .voxel = {}};
  std::vector<double> values;
  for (int i = 0; i < shown.config.learned_after; ++i) values.push_back(100.0 + random.normal(5.0));
  double mean = 0.0, squares = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) squares += (value - mean) * (value - mean);
  for (const double value : values) shown(value);
  EXPECT_TRUE(shown.voxel.learned(shown.config));
  EXPECT_NEAR(static_cast<double>(shown.voxel.mean), mean, 1e-3);
  EXPECT_NEAR(static_cast<double>(shown.voxel.sigma(shown.config)),
              std::sqrt(squares / static_cast<double>(values.size() - 1)), 1e-3);
}

TEST(ThermalVoxel, IsLearnedFromTwoViewpointsOrInALongLookFromOne) {
  Random random(7);
  Shown walking;  // a view in two and a half seconds
  walking.noisy(random, 100.0, 5.0, 20);
  EXPECT_FALSE(walking.voxel.learned(walking.config));
  walking.noisy(random, 100.0, 5.0, 10);
  EXPECT_TRUE(walking.voxel.learned(walking.config));
  EXPECT_NEAR(static_cast<double>(walking.voxel.sigma(walking.config)), 5.0, 2.0);
  Shown standing{.config = {.noise = 4.0, .learned_views = 1000}};
  standing.noisy(random, 100.0, 5.0, 59);
  EXPECT_FALSE(standing.voxel.learned(standing.config));
  standing.noisy(random, 100.0, 5.0, 1);
  EXPECT_TRUE(standing.voxel.learned(standing.config));
  EXPECT_NEAR(static_cast<double>(standing.voxel.sigma(standing.config)), 5.0, 2.0);
}

TEST(ThermalVoxel, FollowsWhatDriftsSlowly) {
  Shown shown;
  for (int i = 0; i < 1500; ++i) shown(100.0 + 0.04 * i);
  EXPECT_FALSE(shown.voxel.hot);
  EXPECT_NEAR(static_cast<double>(shown.voxel.mean), 160.0, 3.0);
}

TEST(ThermalVoxel, DoesNotTakeHeatForNormalHoweverLongItLasts) {
  Random random(2);
  Shown shown;
  shown.noisy(random, 100.0, 3.0, 50);
  const float normal = shown.voxel.mean;
  shown.noisy(random, 150.0, 3.0, 5000);
  EXPECT_TRUE(shown.voxel.hot);
  EXPECT_EQ(shown.voxel.mean, normal);
  EXPECT_NEAR(static_cast<double>(shown.voxel.changed_mean), 150.0, 4.0);
}

TEST(ThermalVoxel, IsAtPresentWhatSeveralImagesShowAndNotOneOddOne) {
  Shown shown;
  for (int i = 0; i < 40; ++i) shown(100.0);
  shown(200.0);
  EXPECT_NEAR(static_cast<double>(shown.voxel.present()), 100.0, 1.0);
  shown(200.0), shown(200.0);
  EXPECT_NEAR(static_cast<double>(shown.voxel.present()), 200.0, 1.0);
}

TEST(ThermalVoxel, CallsHotOnlyWhatSeveralImagesShow) {
  Shown shown;
  for (int i = 0; i < 40; ++i) shown(100.0);
  for (int i = 0; i < 2; ++i) shown(160.0);
  EXPECT_FALSE(shown.voxel.hot);
  shown(160.0);
  EXPECT_TRUE(shown.voxel.hot);
}

TEST(ThermalVoxel, IsKnownFromAFewImagesOnceTheRigHasGoneByAndComesBack) {
  for (const double pause_s : {0.0, 30.0}) {
    Shown shown{.config = {.noise = 4.0, .learned_views = 1, .min_change = 20.0}, .voxel = {}};
    for (int i = 0; i < 5; ++i) shown(100.0);
    EXPECT_FALSE(shown.voxel.learned(shown.config));
    EXPECT_GT(shown.voxel.sigma(shown.config), 1.4 * shown.config.noise) << "five images tell less than twelve";
    shown.time += from_seconds(pause_s);
    for (int i = 0; i < 3; ++i) shown(150.0);
    EXPECT_EQ(shown.voxel.hot, pause_s > 0.0);
  }
}

TEST(ThermalVoxel, ThatWasLearnedFromSaturatedPixelsIsNotHotForBeingBrighter) {
  for (const double saturated : {0.0, 1.0}) {
    Shown shown;
    for (int i = 0; i < 40; ++i) shown(200.0, saturated);
    for (int i = 0; i < 10; ++i) shown(260.0);
    EXPECT_EQ(shown.voxel.hot, saturated == 0.0);
  }
}

TEST(ThermalVoxel, IsKnownByTheImagesThatWereNotSaturatedOnceThereAreSome) {
  Shown shown;
  for (int i = 0; i < 30; ++i) shown(240.0, 1.0);
  for (int i = 0; i < 8; ++i) shown(230.0, 0.0);
  EXPECT_NEAR(shown.voxel.mean, 230.0F, 2.0F);
  EXPECT_LT(shown.voxel.sigma(shown.config), 10.0F);
  for (int i = 0; i < 5; ++i) shown(290.0, 1.0);
  EXPECT_TRUE(shown.voxel.hot);
}

TEST(ThermalVoxel, LearnsNothingFromSaturatedImagesWhereOthersSaidMore) {
  Shown shown;
  for (int i = 0; i < 20; ++i) shown(230.0, 0.0);
  for (int i = 0; i < 50; ++i) shown(240.0, 1.0);
  EXPECT_FLOAT_EQ(shown.voxel.mean, 230.0F);
  EXPECT_FLOAT_EQ(shown.voxel.saturated, 0.0F);
}

TEST(ThermalVoxel, IsHotInSaturatedImagesToo) {
  Shown shown;
  for (int i = 0; i < 40; ++i) shown(100.0);
  for (int i = 0; i < 3; ++i) shown(200.0, 1.0);
  EXPECT_TRUE(shown.voxel.hot);
}

TEST(ThermalVoxel, IsNotHotWhereTheImageItselfOrItsCalibrationIsThatUncertain) {
  Shown spread, doubt;
  for (int i = 0; i < 40; ++i) spread(100.0), doubt(100.0);
  for (int i = 0; i < 10; ++i) spread(140.0, 0.0, 15.0), doubt(140.0, 0.0, 0.0, 15.0);
  EXPECT_FALSE(spread.voxel.hot);
  EXPECT_FALSE(doubt.voxel.hot);
  EXPECT_LT(spread.voxel.mean, 102.0F) << "nor may heat become normal through poor images";
  for (int i = 0; i < 3; ++i) spread(160.0, 0.0, 15.0), doubt(160.0, 0.0, 0.0, 15.0);
  EXPECT_TRUE(spread.voxel.hot);
  EXPECT_TRUE(doubt.voxel.hot);
}

TEST(ThermalVoxel, NeverCallsColdHot) {
  Shown shown;
  for (int i = 0; i < 40; ++i) shown(100.0);
  for (int i = 0; i < 40; ++i) shown(30.0);
  EXPECT_FALSE(shown.voxel.hot);
  EXPECT_GT(shown.voxel.changes, 0);
}

TEST(ThermalVoxel, StaysHotUntilItIsWithinTheLowerLimit) {
  Shown shown;
  for (int i = 0; i < 40; ++i) shown(100.0);
  for (int i = 0; i < 5; ++i) shown(130.0);
  ASSERT_TRUE(shown.voxel.hot);
  for (int i = 0; i < 20; ++i) shown(110.0);  // 2.5 sigma: would not raise it, does not end it
  EXPECT_TRUE(shown.voxel.hot);
  for (int i = 0; i < 2; ++i) shown(104.0);
  EXPECT_TRUE(shown.voxel.hot);
  shown(104.0);
  EXPECT_FALSE(shown.voxel.hot);
  EXPECT_EQ(shown.voxel.changes, 0);
}

TEST(ThermalVoxel, KeepsFalseAlarmsToWhatTheArithmeticOfThreeSigmaSays) {
  // One-sided 3 sigma is 1.35e-3 an image; three images in a row by chance would be 2.5e-9 were they independent of
  // what was learned. A least change of five sigma leaves nothing at all.
  constexpr int kVoxels = 2000, kImages = 300;
  Random random(3);
  int beyond = 0, hot_at_3 = 0, hot_at_5 = 0;
  for (int i = 0; i < kVoxels; ++i) {
    Shown loose{.config = {.noise = 4.0, .learned_after = 60, .learned_views = 1, .min_change = 12.0}, .voxel = {}};
    Shown strict;
    for (int image = 0; image < kImages; ++image) {
      const double value = 100.0 + random.normal(4.0);
      const bool learned = loose.voxel.learned(loose.config);
      const std::uint16_t before = loose.voxel.changes;
      loose(value);
      strict(value);
      beyond += learned && loose.voxel.changes > before ? 1 : 0;
      hot_at_3 += loose.voxel.hot ? 1 : 0;
      hot_at_5 += strict.voxel.hot ? 1 : 0;
    }
  }
  const double share = beyond / static_cast<double>(kVoxels * (kImages - 60));
  EXPECT_LT(share, 2.0 * 2.7e-3);  // both signs
  EXPECT_GT(share, 0.1 * 2.7e-3);  // the gate is there
  EXPECT_LT(hot_at_3, kVoxels * kImages / 100000);
  EXPECT_EQ(hot_at_5, 0);
}

TEST(ThermalVoxel, RemembersTheMostThatTwoImagesInARowShowed) {
  Shown shown;
  for (const double value : {100.0, 190.0, 100.0, 140.0, 150.0, 100.0}) shown(value);
  EXPECT_FLOAT_EQ(shown.voxel.brightest, 140.0F);
  EXPECT_EQ(shown.voxel.brightest_at, Time{} + std::chrono::milliseconds(500));
  shown(220.0, 0.0, 0.0, 50.0);  // in images that say little
  shown(220.0, 0.0, 0.0, 50.0);
  EXPECT_FLOAT_EQ(shown.voxel.brightest, 140.0F);
}

TEST(ThermalVoxel, CountsViewpointsAQuarterOfAMetreApart) {
  Shown shown;
  for (int i = 0; i < 100; ++i) shown(100.0);  // a walk of 1 m
  EXPECT_EQ(shown.voxel.views, 4);
}

/// Whether a voxel that showed 100 for four seconds is hot when it shows 200 for one, beside edges of the image.
bool gets_hot(double rise_before, double dip_now) {
  Shown shown;
  for (int i = 0; i < 40; ++i) shown.beside(100.0, 0.0, rise_before);
  for (int i = 0; i < 10; ++i) shown.beside(200.0, dip_now, 0.0);
  return shown.voxel.hot;
}

TEST(ThermalVoxel, IsHotWhereMoreChangedThanAnEdgeThatLiesAFewPixelsOffExplains) {
  EXPECT_TRUE(gets_hot(0.0, 0.0));
  EXPECT_TRUE(gets_hot(40.0, 40.0)) << "edges of less contrast than the change";
  EXPECT_FALSE(gets_hot(100.0, 0.0)) << "something as bright has always been next to it in the image";
  EXPECT_FALSE(gets_hot(0.0, 100.0)) << "and is now, with what it showed before on the other side";
}

}  // namespace
}  // namespace pllit
