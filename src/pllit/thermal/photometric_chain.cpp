#include "pllit/thermal/photometric_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace pllit {
namespace {

constexpr int kPlaces = 9;
constexpr int kQuantiles = 17;

std::array<Eigen::Vector2f, kPlaces> places() {
  constexpr float kRadius_px = 6.0F;
  std::array<Eigen::Vector2f, kPlaces> places{};
  for (std::size_t i = 1; i < kPlaces; ++i) {
    const float angle = std::numbers::pi_v<float> * static_cast<float>(i) / 4.0F;
    places[i] = kRadius_px * Eigen::Vector2f(std::cos(angle), std::sin(angle));
  }
  places[0].setZero();
  return places;
}

float bilinear(const cv::Mat& image, const Eigen::Vector2f& at) {
  const auto left = static_cast<int>(std::floor(at.x())), top = static_cast<int>(std::floor(at.y()));
  if (left < 0 || top < 0 || left + 1 >= image.cols || top + 1 >= image.rows)
    return std::numeric_limits<float>::quiet_NaN();
  const float u = at.x() - static_cast<float>(left), v = at.y() - static_cast<float>(top);
  const auto *upper = image.ptr<float>(top) + left, *lower = image.ptr<float>(top + 1) + left;
  return std::lerp(std::lerp(upper[0], upper[1], u), std::lerp(lower[0], lower[1], u), v);
}

cv::Mat smoothed(const cv::Mat& image) {
  cv::Mat smooth;
  image.convertTo(smooth, CV_32F);
  cv::GaussianBlur(smooth, smooth, {5, 5}, 1.0, 1.0, cv::BORDER_REPLICATE);
  return smooth;
}

/// The smooth image with NaN near clipped pixels and on steep edges, where a fraction of a pixel changes the grey.
cv::Mat tellable(const cv::Mat& image, const cv::Mat& smooth) {
  cv::Mat clipped, dx, dy, slope;
  cv::Sobel(smooth, dx, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(smooth, dy, CV_32F, 0, 1, 3, 0.125);
  cv::magnitude(dx, dy, slope);
  cv::Scalar mean, deviation;
  cv::meanStdDev(smooth, mean, deviation);
  constexpr double kSteep = 0.12;  // standard deviations of the image a pixel
  cv::Mat useless = slope > kSteep * deviation[0];
  if (image.depth() == CV_8U) {
    cv::inRange(image, cv::Scalar(2), cv::Scalar(253), clipped);  // 0 where clipped
    cv::erode(clipped, clipped, cv::getStructuringElement(cv::MORPH_RECT, {5, 5}));
    useless |= clipped == 0;
  }
  cv::Mat telling = smooth.clone();
  telling.setTo(std::numeric_limits<float>::quiet_NaN(), useless);
  return telling;
}

/// Raw greys at even shares of the image's pixels, ascending.
std::array<double, kQuantiles> quantiles_of(const cv::Mat& grey) {
  std::array<std::uint32_t, 256> histogram{};
  for (int row = 0; row < grey.rows; ++row)
    for (int column = 0; column < grey.cols; ++column) ++histogram[grey.at<std::uint8_t>(row, column)];
  std::array<double, kQuantiles> quantiles{};
  double below = 0.0;
  std::size_t value = 0;
  for (std::size_t i = 0; i < kQuantiles; ++i) {
    const double rank = (static_cast<double>(i) + 0.5) / kQuantiles * static_cast<double>(grey.total());
    while (value < 255 && below + histogram[value] <= rank) below += histogram[value++];
    quantiles[i] = static_cast<double>(value) - 0.5 + (rank - below) / std::max<double>(histogram[value], 1.0);
  }
  return quantiles;
}

cv::Mat calibrated_quantiles(const cv::Mat& grey, const GreyCurve& curve) {
  cv::Mat row(1, kQuantiles, CV_64FC1);
  const std::array<double, kQuantiles> raw = quantiles_of(grey);
  for (int i = 0; i < kQuantiles; ++i) row.at<double>(i) = curve(raw[static_cast<std::size_t>(i)]);
  return row;
}

}  // namespace

cv::Mat greys_around(const cv::Mat& image, std::span<const Eigen::Vector2f> points_px) {
  const cv::Mat smooth = smoothed(image), telling = tellable(image, smooth);
  const auto offsets = places();
  cv::Mat greys(static_cast<int>(points_px.size()), kPlaces, CV_32FC1);
  for (int i = 0; i < greys.rows; ++i)
    for (int k = 0; k < kPlaces; ++k)
      greys.at<float>(i, k) = bilinear(k == 0 ? smooth : telling,
                                       points_px[static_cast<std::size_t>(i)] + offsets[static_cast<std::size_t>(k)]);
  return greys;
}

void set_greys(Keyframe& keyframe, const cv::Mat& around, const GreyCurve& curve) {
  const int points = static_cast<int>(keyframe.features.points_px.size());
  keyframe.greys_around = around.rowRange(0, points).clone();
  keyframe.greys.clear();
  for (int i = 0; i < points; ++i) {
    auto* row = keyframe.greys_around.ptr<float>(i);
    for (int k = 0; k < kPlaces; ++k) row[k] = static_cast<float>(curve(static_cast<double>(row[k])));
    keyframe.greys.push_back(row[0]);
  }
}

std::vector<GreyPair> grey_pairs(const Tracks& tracks, std::span<const Keyframe> window, const cv::Mat& around_now,
                                 int most) {
  std::vector<GreyPair> pairs;
  const std::size_t all = tracks.points.size() * kPlaces,
                    step = std::max<std::size_t>(
                        1, (all + static_cast<std::size_t>(most) - 1) / static_cast<std::size_t>(most));
  // Strides that share no factor with the places' number visit all places alike.
  const std::size_t stride = step % 3 == 0 ? step + 1 : step;
  for (std::size_t i = 0; i < all; i += stride) {
    const PointMatch& match = tracks.points[i / kPlaces];
    const auto place = static_cast<int>(i % kPlaces);
    const cv::Mat& reference = window[match.keyframe].greys_around;
    if (reference.empty()) continue;
    const GreyPair pair{.reference = reference.at<float>(match.reference, place),
                        .current = around_now.at<float>(match.current, place)};
    if (std::isfinite(pair.reference) && std::isfinite(pair.current)) pairs.push_back(pair);
  }
  return pairs;
}

PhotometricChain restarted(const PhotometricChain& chain, const cv::Mat& grey) {
  if (chain.quantiles.empty()) return chain;
  const std::array<double, kQuantiles> raw = quantiles_of(grey);
  std::vector<GreyPair> pairs;
  for (int i = 0; i < kQuantiles; ++i)
    pairs.push_back({.reference = static_cast<float>(chain.quantiles.at<double>(i)),
                     .current = static_cast<float>(raw[static_cast<std::size_t>(i)])});
  PhotometricChain fresh = chain;
  fresh.curve = fit_grey_curve(pairs, GreyCurve{}, {.loss_grey = 20.0, .min_pairs = kQuantiles / 2}).curve;
  return fresh;
}

ChainStep advanced(const PhotometricChain& chain, const cv::Mat& grey, const cv::Mat& around_now, const Tracks& tracks,
                   std::span<const Keyframe> window, const ChainConfig& config) {
  const std::vector<GreyPair> pairs = grey_pairs(tracks, window, around_now, config.most_pairs);
  ChainStep step{.chain = chain, .fit = fit_grey_curve(pairs, chain.curve, config.fit)};
  step.chain.curve = step.fit.curve;
  step.chain.quantiles = calibrated_quantiles(grey, step.chain.curve);
  return step;
}

PhotometricChain in_fresh_greys(const PhotometricChain& chain, std::span<Keyframe> window, const ChainConfig& config) {
  constexpr double kMiddle = 128.0;
  const double gain = chain.curve.gain, bias = chain.curve.bias;
  const bool stretched = std::max(gain, 1.0 / gain) > config.most_stretch,
             shifted = std::abs(gain * kMiddle + bias - kMiddle) > config.most_shift_grey;
  if (!stretched && !shifted) return chain;
  const auto fresh = [&](cv::Mat& greys) { greys = (greys - bias) / gain; };
  for (Keyframe& keyframe : window) {
    for (float& grey : keyframe.greys) grey = static_cast<float>((static_cast<double>(grey) - bias) / gain);
    if (!keyframe.greys_around.empty()) fresh(keyframe.greys_around);
  }
  PhotometricChain result{.curve = chain.curve, .quantiles = chain.quantiles.clone()};
  if (!result.quantiles.empty()) fresh(result.quantiles);
  result.curve.gain = 1.0;
  result.curve.bias = 0.0;
  for (double& offset : result.curve.offsets) offset /= gain;
  return result;
}

}  // namespace pllit
