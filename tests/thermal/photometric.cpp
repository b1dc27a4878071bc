#include "pllit/thermal/photometric.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace pllit {
namespace {

using Kind = PhotometricFit::Kind;

struct Tracks {
  int count = 200;
  double noise_grey = 1.5;
  double false_share = 0.0;
  double from_grey = 40.0, to_grey = 215.0;  ///< raw
};

/// Pairs whose reference is `truth` of the current grey, but for noise and false matches.
std::vector<GreyPair> pairs_of(const std::function<double(double)>& truth, const Tracks& tracks, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise(0.0, tracks.noise_grey);
  std::uniform_real_distribution<double> raw(tracks.from_grey, tracks.to_grey), share(0.0, 1.0);
  std::vector<GreyPair> pairs;
  for (int i = 0; i < tracks.count; ++i) {
    const double grey = raw(engine), seen = share(engine) < tracks.false_share ? raw(engine) : grey;
    pairs.push_back(
        {static_cast<float>(truth(seen) + noise(engine)), static_cast<float>(std::round(grey + noise(engine)))});
  }
  return pairs;
}

/// Largest deviation over the middle 90 % of the greys that occur.
double deviation(const GreyCurve& curve, const std::function<double(double)>& truth, const Tracks& tracks) {
  double worst = 0.0;
  const double width = tracks.to_grey - tracks.from_grey;
  for (double share = 0.05; share <= 0.95; share += 0.01)
    worst =
        std::max(worst, std::abs(curve(tracks.from_grey + share * width) - truth(tracks.from_grey + share * width)));
  return worst;
}

TEST(PhotometricCalibration, FindsGainAndBiasToTwoGreyLevels) {
  unsigned seed = 1;
  for (const double gain : {0.6, 0.8, 1.0, 1.3, 1.6})
    for (const double bias : {-40.0, 0.0, 40.0}) {
      const auto truth = [=](double raw) { return gain * raw + bias; };
      const PhotometricFit fit = fit_grey_curve(pairs_of(truth, {}, seed++), GreyCurve{}, {});
      EXPECT_EQ(fit.kind, Kind::affine) << gain << ", " << bias;
      EXPECT_LT(deviation(fit.curve, truth, {}), 2.0) << gain << ", " << bias;
    }
}

TEST(PhotometricCalibration, WithstandsAThirdOfFalseMatches) {
  unsigned seed = 100;
  for (const double gain : {0.6, 1.0, 1.6})
    for (const double bias : {-40.0, 40.0}) {
      const Tracks tracks{.false_share = 0.3};
      const auto truth = [=](double raw) { return gain * raw + bias; };
      const PhotometricFit fit = fit_grey_curve(pairs_of(truth, tracks, seed++), GreyCurve{}, {});
      EXPECT_LT(deviation(fit.curve, truth, tracks), 3.0) << gain << ", " << bias;
    }
}

TEST(PhotometricCalibration, TakesACurveOnlyWhereALineCannotFollow) {
  const auto bent = [](double raw) { return 255.0 * std::pow(raw / 255.0, 0.6); };
  unsigned seed = 200;
  for (const double false_share : {0.0, 0.3}) {
    const Tracks tracks{.false_share = false_share};
    const PhotometricFit fit = fit_grey_curve(pairs_of(bent, tracks, seed++), GreyCurve{}, {});
    EXPECT_EQ(fit.kind, Kind::curve);
    EXPECT_LT(deviation(fit.curve, bent, tracks), false_share > 0.0 ? 6.0 : 4.0);
  }
}

TEST(PhotometricCalibration, GivesCurvesThatKeepTheOrderOfGreys) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<float> grey(3.0F, 252.0F);
  for (int i = 0; i < 50; ++i) {
    std::vector<GreyPair> pairs;
    for (int k = 0; k < 120; ++k) pairs.push_back({grey(engine), grey(engine)});
    const PhotometricFit fit = fit_grey_curve(pairs, GreyCurve{}, {});
    for (int raw = 1; raw < 256; ++raw) ASSERT_GT(fit.curve(raw), fit.curve(raw - 1));
  }
}

TEST(PhotometricCalibration, KeepsTheLastCurveWhereTooFewPairsTellAnything) {
  const GreyCurve before{.gain = 1.2, .bias = -7.0, .knots = {}, .offsets = {}};
  const auto truth = [](double raw) { return 0.7 * raw; };
  const PhotometricFit few = fit_grey_curve(pairs_of(truth, {.count = 11}, 3), before, {});
  EXPECT_EQ(few.kind, Kind::kept);
  EXPECT_EQ(few.curve.gain, 1.2);
  const PhotometricFit none = fit_grey_curve({}, before, {});
  EXPECT_EQ(none.curve.bias, -7.0);
  std::vector<GreyPair> clipped(100, GreyPair{.reference = 100.0F, .current = 255.0F});
  EXPECT_EQ(fit_grey_curve(clipped, before, {}).kind, Kind::kept);
}

TEST(PhotometricCalibration, FindsTheBiasAloneAmongGreysThatAreAlike) {
  const GreyCurve before{.gain = 1.1, .bias = 0.0, .knots = {}, .offsets = {}};
  const auto truth = [](double raw) { return 1.1 * raw + 12.0; };
  const PhotometricFit fit = fit_grey_curve(pairs_of(truth, {.from_grey = 118.0, .to_grey = 126.0}, 4), before, {});
  EXPECT_EQ(fit.kind, Kind::bias);
  EXPECT_EQ(fit.curve.gain, 1.1);
  EXPECT_NEAR(fit.curve(122.0), truth(122.0), 1.0);
}

TEST(PhotometricCalibration, DoesNotWanderFromKeyframeToKeyframe) {
  // The reference of each keyframe is calibrated by the curve of the one before: errors are handed on a thousand times.
  std::mt19937 engine(5);
  std::normal_distribution<double> noise(0.0, 1.5);
  std::uniform_real_distribution<double> grey(40.0, 215.0);
  GreyCurve keyframe;
  double worst = 0.0;
  for (int k = 0; k < 1000; ++k) {
    std::vector<GreyPair> pairs;
    for (int i = 0; i < 150; ++i) {
      const double raw = grey(engine);
      pairs.push_back({static_cast<float>(keyframe(raw + noise(engine))), static_cast<float>(raw + noise(engine))});
    }
    keyframe = fit_grey_curve(pairs, keyframe, {}).curve;
    worst = std::max(worst, std::abs(keyframe(128.0) - 128.0));
  }
  RecordProperty("worst_grey", std::to_string(worst));
  EXPECT_LT(worst, 60.0);
  EXPECT_GT(keyframe.gain, 0.4);
  EXPECT_LT(keyframe.gain, 2.0);
}

TEST(PhotometricCalibration, CorrectsAnImageGreyByGrey) {
  const GreyCurve curve{.gain = 1.5, .bias = -20.0, .knots = {50.0, 150.0}, .offsets = {0.0, 10.0}};
  cv::Mat raw(2, 3, CV_8UC1);
  for (int i = 0; i < 6; ++i) raw.data[i] = static_cast<std::uint8_t>(40 * i);
  const cv::Mat image = corrected(raw, curve);
  for (int i = 0; i < 6; ++i) EXPECT_FLOAT_EQ(image.ptr<float>()[i], static_cast<float>(curve(40.0 * i)));
}

}  // namespace
}  // namespace pllit
