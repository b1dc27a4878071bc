#include "pllit/thermal/photometric_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "thermal/pictures.hpp"

namespace pllit {
namespace {

using Eigen::Vector2f;

const cv::Mat kScene = test::scene({}, 31);

std::vector<Vector2f> grid() {
  std::vector<Vector2f> points;
  for (float y = 20.0F; y < 240.0F; y += 16.0F)
    for (float x = 20.0F; x < 300.0F; x += 16.0F) points.emplace_back(x + 0.3F, y + 0.6F);
  return points;
}

/// The scene's image after gain control: raw = (grey - bias) / gain.
cv::Mat raw_image(double gain, double bias, unsigned seed) {
  cv::Mat raw;
  kScene.convertTo(raw, CV_32F, 1.0 / gain, -bias / gain);
  return test::seen(raw, 1.0, seed);
}

Keyframe keyframe_of(const cv::Mat& raw, const GreyCurve& curve) {
  Keyframe keyframe;
  keyframe.features.points_px = grid();
  set_greys(keyframe, greys_around(raw, keyframe.features.points_px), curve);
  return keyframe;
}

Tracks all_matched(std::size_t keyframes) {
  Tracks tracks;
  for (std::size_t k = 0; k < keyframes; ++k)
    for (int i = 0; i < static_cast<int>(grid().size()); ++i)
      tracks.points.push_back({.keyframe = k, .reference = i, .current = i});
  return tracks;
}

double worst(const GreyCurve& curve, double gain, double bias) {
  double deviation = 0.0;
  for (double grey = 40.0; grey <= 210.0; grey += 5.0) {
    const double raw = (grey - bias) / gain;
    if (raw > 5.0 && raw < 250.0) deviation = std::max(deviation, std::abs(curve(raw) - grey));
  }
  return deviation;
}

TEST(PhotometricChain, SamplesGreysBetweenPixels) {
  cv::Mat ramp(40, 60, CV_8UC1);
  for (int row = 0; row < ramp.rows; ++row)
    for (int column = 0; column < ramp.cols; ++column)
      ramp.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(3 * column + row);
  const std::vector<Vector2f> points{{20.25F, 11.5F}, {1.0F, 20.0F}};
  const cv::Mat greys = greys_around(ramp, points);
  EXPECT_NEAR(greys.at<float>(0, 0), 3.0F * 20.25F + 11.5F, 1e-3F);
  EXPECT_NEAR(greys.at<float>(0, 8), 3.0F * 26.25F + 11.5F, 1e-3F);  // 6 px to the right
  EXPECT_TRUE(std::isnan(greys.at<float>(1, 4)));                    // 6 px to the left, outside
}

TEST(PhotometricChain, FollowsStepsOfGainControlThroughTheWindow) {
  PhotometricChain chain;
  std::vector<Keyframe> window{keyframe_of(raw_image(1.0, 0.0, 1), chain.curve)};
  unsigned seed = 2;
  for (const auto& [gain, bias] : {std::pair(0.7, 30.0), {1.5, -40.0}, {1.0, 15.0}}) {
    const cv::Mat raw = raw_image(gain, bias, seed++), around = greys_around(raw, grid());
    chain = advanced(chain, raw, around, all_matched(window.size()), window, {}).chain;
    EXPECT_LT(worst(chain.curve, gain, bias), 2.0) << gain << ", " << bias;
    window.push_back(keyframe_of(raw, chain.curve));
  }
}

TEST(PhotometricChain, DoesNotWanderOverManyHandovers) {
  PhotometricChain chain;
  std::vector<Keyframe> window{keyframe_of(raw_image(1.0, 0.0, 1), chain.curve)};
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> gain(0.7, 1.4), bias(-20.0, 20.0);
  double deviation = 0.0;
  for (unsigned k = 0; k < 60; ++k) {
    const double a = gain(engine), b = bias(engine);
    const cv::Mat raw = raw_image(a, b, 100 + k);
    chain = advanced(chain, raw, greys_around(raw, grid()), all_matched(window.size()), window, {}).chain;
    deviation = worst(chain.curve, a, b);
    window.push_back(keyframe_of(raw, chain.curve));
    if (window.size() > 4) window.erase(window.begin());
  }
  EXPECT_LT(deviation, 8.0);
}

TEST(PhotometricChain, StartsAgainFromTheGreysOfTheImageBeforeTheShutter) {
  PhotometricChain chain;
  const std::vector<Keyframe> window{keyframe_of(raw_image(1.0, 0.0, 1), chain.curve)};
  const cv::Mat before = raw_image(1.0, 0.0, 2);
  chain = advanced(chain, before, greys_around(before, grid()), all_matched(1), window, {}).chain;
  const PhotometricChain fresh = restarted(chain, raw_image(1.4, -50.0, 3));
  EXPECT_LT(worst(fresh.curve, 1.4, -50.0), 6.0);
  EXPECT_EQ(restarted({}, before).curve.gain, 1.0) << "nothing to start from";
}

TEST(PhotometricChain, TakesTheGreysOfALaterImageWhereThoseOfTheFirstAreFarOff) {
  PhotometricChain chain;  // the first image is four times as dark as later ones
  std::vector<Keyframe> window{keyframe_of(raw_image(4.0, 0.0, 1), chain.curve)};
  const cv::Mat later = raw_image(1.0, 0.0, 2);
  const auto step = [&](const cv::Mat& raw) {
    const cv::Mat around = greys_around(raw, grid());
    return advanced(chain, raw, around, all_matched(window.size()), window, {}).chain;
  };
  chain = step(later);
  ASSERT_NEAR(chain.curve.gain, 0.25, 0.03) << "it squeezes the good image to the greys of the poor one";
  chain = in_fresh_greys(chain, window, {});
  EXPECT_EQ(chain.curve.gain, 1.0);
  EXPECT_EQ(chain.curve.bias, 0.0);
  chain = step(raw_image(1.0, 0.0, 3));
  EXPECT_LT(worst(chain.curve, 1.0, 0.0), 4.0) << "and the window tells the same of the next one";
  const auto unchanged = in_fresh_greys(chain, window, {});
  EXPECT_EQ(unchanged.curve.gain, chain.curve.gain);
}

TEST(PhotometricChain, UsesNoMoreGreysThanAskedAndNoneThatAreMissing) {
  const cv::Mat raw = raw_image(1.0, 0.0, 1), around = greys_around(raw, grid());
  std::vector<Keyframe> window{keyframe_of(raw, {}), Keyframe{}};
  window[1].features.points_px = grid();
  EXPECT_LE(grey_pairs(all_matched(2), window, around, 500).size(), 500U);
  EXPECT_GT(grey_pairs(all_matched(1), window, around, 500).size(), 300U);
  EXPECT_TRUE(grey_pairs({}, window, around, 500).empty());
}

}  // namespace
}  // namespace pllit
