#include "pllit/map/anchor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

/// What a gain control may do: increasing, bent.
double bent(double normal) { return 20.0 + 210.0 * std::pow(std::clamp(normal / 255.0, 0.0, 1.5), 0.6); }

/// Pairs of a scene whose normal greys lie between 40 and 180; a share of it has become hot.
std::vector<AnchorPair> scene(Random& random, int count, double hot_share, double (*gain_control)(double)) {
  std::vector<AnchorPair> pairs;
  for (int i = 0; i < count; ++i) {
    const double normal = random.uniform(40.0, 180.0);
    const double now = i < hot_share * count ? normal + 90.0 : normal;
    pairs.push_back({.now = static_cast<float>(gain_control(now) + random.normal(1.5)),
                     .normal = static_cast<float>(normal + random.normal(1.5))});
  }
  return pairs;
}

TEST(AnchorCurve, UndoesAnAffineGainControl) {
  Random random(1);
  const auto gain_control = [](double normal) { return 0.6 * normal + 35.0; };
  const AnchorFit fit =
      anchor_curve(scene(random, 2000, 0.0, gain_control), {}, {.shape = AnchorConfig::Shape::affine});
  ASSERT_TRUE(fit.holds);
  for (const double normal : {50.0, 100.0, 170.0}) EXPECT_NEAR(fit.curve(gain_control(normal)), normal, 1.0);
}

TEST(AnchorCurve, UndoesABentOne) {
  Random random(2);
  const AnchorFit fit = anchor_curve(scene(random, 3000, 0.0, bent), {}, {});
  ASSERT_TRUE(fit.holds);
  for (const double normal : {50.0, 80.0, 110.0, 140.0, 170.0}) EXPECT_NEAR(fit.curve(bent(normal)), normal, 2.0);
  EXPECT_LT(fit.rms, 4.0);
}

TEST(AnchorCurve, IsNotDraggedByAThirdOfTheImageThatHasBecomeHot) {
  Random random(3);
  for (const auto gain_control : {+[](double normal) { return 0.7 * normal + 10.0; }, +bent}) {
    const AnchorFit fit = anchor_curve(scene(random, 3000, 0.33, gain_control), {}, {});
    ASSERT_TRUE(fit.holds);
    for (const double normal : {60.0, 110.0, 160.0}) EXPECT_NEAR(fit.curve(gain_control(normal)), normal, 4.0);
    // Hot things stay hot, even brighter than anything that did not change.
    EXPECT_GT(fit.curve(gain_control(270.0)), 180.0);
  }
}

TEST(AnchorCurve, IsDoubtedBeyondWhatKnownSurfacesShow) {
  Random random(6);
  const AnchorFit fit = anchor_curve(scene(random, 3000, 0.1, bent), {}, {});
  ASSERT_TRUE(fit.holds);
  EXPECT_EQ(fit.curve.doubt(bent(60.0)), 0.0);
  EXPECT_EQ(fit.curve.doubt(bent(160.0)), 0.0);
  const double error = std::abs(fit.curve(bent(300.0)) - 300.0), doubt = fit.curve.doubt(bent(300.0));
  EXPECT_GT(doubt, error / 3.0);
  EXPECT_LT(3.0 * doubt, fit.curve(bent(300.0)) - 180.0) << "what is so much hotter must still count as hot";
}

TEST(AnchorCurve, IsNotHeldByWhatWasItselfLearnedInDoubt) {
  Random random(7);
  std::vector<AnchorPair> pairs = scene(random, 3000, 0.0, bent);
  for (AnchorPair& pair : pairs)
    if (pair.normal > 120.0F) pair.trust = 1e-3F;
  EXPECT_GT(anchor_curve(pairs, {}, {}).curve.doubt(bent(170.0)), 5.0);
}

/// A dark thing comes into sight in a hall of which only bright surfaces have been seen for a while.
TEST(AnchorCurve, TurnsToDarkSurfacesThatComeIntoSight) {
  Random random(8);
  const auto steep = [](double normal) { return normal < 100.0 ? 0.8 * normal + 10.0 : 1.6 * normal - 70.0; };
  std::vector<AnchorPair> pairs;
  const auto add = [&](int count, double low, double high) {
    for (int i = 0; i < count; ++i) {
      const double normal = random.uniform(low, high);
      pairs.push_back({.now = static_cast<float>(steep(normal) + random.normal(2.0)),
                       .normal = static_cast<float>(normal + random.normal(2.0))});
    }
  };
  add(2000, 120.0, 190.0);
  const AnchorFit before = anchor_curve(pairs, {}, {});
  add(250, 30.0, 80.0);
  const AnchorFit fit = anchor_curve(pairs, before.curve, {});
  ASSERT_TRUE(fit.holds);
  for (const double normal : {35.0, 50.0, 70.0, 130.0, 180.0}) EXPECT_NEAR(fit.curve(steep(normal)), normal, 8.0);
}

/// Left out at once, dark surfaces that the curve does not fit yet could never turn it.
TEST(AnchorPairs, OfSurfacesThatLookUnusualWeighLessFromImageToImage) {
  ThermalMap map({});
  const Camera camera{.width = 320, .height = 256, .fx = 300.0, .fy = 300.0, .cx = 160.0, .cy = 128.0};
  SurfaceObservation observation{.p_W = Vector3d(3.0, 0.0, 0.0), .pixel_px = {160.0F, 128.0F}, .intensity = 100.0F};
  std::vector<float> weights;
  for (int image = 0; image < 30; ++image) {
    observation.intensity = image < 20 ? 100.0F : 160.0F;
    if (image >= 20) weights.push_back(anchor_pairs(map, {observation}, camera).at(0).weight);
    map.integrate({.time = Time{std::chrono::milliseconds(100 * image)},
                   .viewpoint_W = Vector3d(0.0, 0.1 * image, 0.0),
                   .observations = {observation}});
  }
  EXPECT_FLOAT_EQ(weights.front(), 1.0F);
  EXPECT_TRUE(std::ranges::is_sorted(weights, std::greater{}));
  EXPECT_GT(weights[2], 0.3F);
  EXPECT_LT(weights.back(), 0.15F);
}

TEST(AnchorPairs, OfSurfacesThatWereSaturatedAreTrustedLittle) {
  const Camera camera{.width = 320, .height = 256, .fx = 300.0, .fy = 300.0, .cx = 160.0, .cy = 128.0};
  const auto trust_of = [&](bool saturated) {
    ThermalMap map({});
    const SurfaceObservation observation{.p_W = Vector3d(3.0, 0.0, 0.0),
                                         .pixel_px = {160.0F, 128.0F},
                                         .intensity = 250.0F,
                                         .saturated = saturated};
    for (int image = 0; image < 20; ++image)
      map.integrate({.time = Time{std::chrono::milliseconds(100 * image)}, .observations = {observation}});
    return anchor_pairs(map, {observation}, camera).at(0).trust;
  };
  EXPECT_FLOAT_EQ(trust_of(false), 1.0F);
  EXPECT_LT(trust_of(true), 0.05F);
}

TEST(AnchorCurve, IsDoubtedWhereMostSurfacesContradictIt) {
  Random random(9);
  std::vector<AnchorPair> pairs;
  const auto add = [&](int count, double low, double high, double change) {
    for (int i = 0; i < count; ++i) {
      const double normal = random.uniform(low, high);
      pairs.push_back({.now = static_cast<float>(normal + change + random.normal(2.0)),
                       .normal = static_cast<float>(normal + random.normal(2.0))});
    }
  };
  add(2000, 100.0, 190.0, 0.0);
  add(60, 40.0, 100.0, 0.0);      // what agrees at 40 to 100 ...
  add(600, 100.0, 110.0, -50.0);  // ... and what does not
  const AnchorFit fit = anchor_curve(pairs, {}, {});
  ASSERT_TRUE(fit.holds);
  EXPECT_GT(fit.curve.doubt(55.0), 5.0);
  EXPECT_LT(fit.curve.doubt(120.0), 0.1);
}

TEST(AnchorCurve, SaysHowWellTheWholeImageFits) {
  for (const double noise : {2.0, 15.0}) {
    Random random(8);
    std::vector<AnchorPair> pairs = scene(random, 3000, 0.0, +[](double normal) { return normal; });
    for (AnchorPair& pair : pairs) pair.now += static_cast<float>(random.normal(noise));
    EXPECT_NEAR(anchor_curve(pairs, {}, {}).spread, std::hypot(noise, 2.1), 0.25 * noise);
  }
}

TEST(AnchorCurve, Increases) {
  Random random(4);
  for (int round = 0; round < 20; ++round) {
    std::vector<AnchorPair> pairs = scene(random, 400, 0.3, bent);
    const AnchorFit fit = anchor_curve(pairs, {}, {});
    double last = fit.curve(-10.0);
    for (double now = -9.0; now < 300.0; now += 1.0) {
      EXPECT_GT(fit.curve(now), last);
      last = fit.curve(now);
    }
  }
}

TEST(AnchorCurve, OfARadiometricCameraOnlyShifts) {
  Random random(5);
  std::vector<AnchorPair> pairs;
  for (int i = 0; i < 500; ++i) {
    const double K = random.uniform(290.0, 300.0);
    pairs.push_back({.now = static_cast<float>(K + 0.4 + random.normal(0.1)), .normal = static_cast<float>(K)});
  }
  const AnchorFit fit = anchor_curve(pairs, {}, {.shape = AnchorConfig::Shape::bias, .loss = 1.0});
  ASSERT_TRUE(fit.holds);
  EXPECT_EQ(fit.curve.gain, 1.0);
  EXPECT_NEAR(fit.curve.bias, -0.4, 0.02);
}

TEST(AnchorCurve, StaysAsItWasWhereThePairsAreFewOrFitNoCurve) {
  Random random(6);
  const AnchorCurve before{.gain = 1.2, .bias = -3.0, .knots = {}, .offsets = {}};
  EXPECT_FALSE(anchor_curve(scene(random, 100, 0.0, bent), before, {}).holds);
  std::vector<AnchorPair> noise;
  for (int i = 0; i < 2000; ++i)
    noise.push_back({.now = static_cast<float>(random.uniform(0.0, 255.0)),
                     .normal = static_cast<float>(random.uniform(0.0, 255.0))});
  const AnchorFit fit = anchor_curve(noise, before, {});
  EXPECT_FALSE(fit.holds);
  EXPECT_EQ(fit.curve.gain, before.gain);
  EXPECT_EQ(fit.curve.bias, before.bias);
}

}  // namespace
}  // namespace pllit
