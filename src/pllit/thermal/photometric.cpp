#include "pllit/thermal/photometric.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "pllit/base/robust.hpp"

namespace pllit {
namespace {

constexpr std::array<double, 6> kLossWidths{60.0, 40.0, 25.0, 16.0, 1.0, 1.0};  // grey; at least the configured one

struct Residuals {
  int inliers = 0;
  double rms_grey = 0.0;
};

Residuals residuals_of(std::span<const GreyPair> pairs, const GreyCurve& curve, double width) {
  Residuals result;
  double sum = 0.0;
  for (const GreyPair& pair : pairs) {
    const double r = pair.reference - curve(pair.current);
    if (std::abs(r) >= width) continue;
    ++result.inliers;
    sum += r * r;
  }
  result.rms_grey = result.inliers > 0 ? std::sqrt(sum / result.inliers) : 0.0;
  return result;
}

double spread_of_raw(std::span<const GreyPair> pairs) {
  double sum = 0.0, squares = 0.0;
  for (const GreyPair& pair : pairs) {
    sum += pair.current;
    squares += pair.current * pair.current;
  }
  const double n = static_cast<double>(pairs.size()), mean = sum / n;
  return std::sqrt(std::max(0.0, squares / n - mean * mean));
}

/// Sums of one round over the pairs, with the weights that the last curve gives them.
struct WeightedSums {
  double weights = 0.0, raw = 0.0, raw_raw = 0.0, reference = 0.0, reference_reference = 0.0, raw_reference = 0.0;
};

WeightedSums sums_of(std::span<const GreyPair> pairs, const GreyCurve& last, double width) {
  WeightedSums s;
  for (const GreyPair& pair : pairs) {
    const double w = tukey_weight(pair.reference - last(pair.current), width);
    s.weights += w;
    s.raw += w * pair.current;
    s.raw_raw += w * pair.current * pair.current;
    s.reference += w * pair.reference;
    s.reference_reference += w * pair.reference * pair.reference;
    s.raw_reference += w * pair.current * pair.reference;
  }
  return s;
}

/// The slope of the least squares in the reference alone would be too small by the noise of the current greys, a little
/// with every keyframe. Both images see one scene from almost the same place, so their noise is alike by its share of
/// the contrast; then the ratio of the standard deviations is the slope (the reduced major axis: Kermack and Haldane
/// 1950).
double slope_of(const WeightedSums& s) {
  const double raw_variance = s.raw_raw - s.raw * s.raw / s.weights,
               reference_variance = s.reference_reference - s.reference * s.reference / s.weights,
               covariance = s.raw_reference - s.raw * s.reference / s.weights;
  if (raw_variance <= 0.0 || covariance <= 0.0) return 0.0;
  const double plain = covariance / raw_variance, correlation2 = covariance * plain / reference_variance;
  return correlation2 > 0.5 ? std::sqrt(reference_variance / raw_variance) : plain;
}

/// One round of the reweighted least squares in gain and bias.
GreyCurve affine_round(std::span<const GreyPair> pairs, const GreyCurve& last, double width, bool gain_too,
                       const PhotometricConfig& config) {
  const WeightedSums s = sums_of(pairs, last, width);
  if (s.weights <= 0.0) return last;
  GreyCurve curve;
  curve.gain = gain_too ? (slope_of(s) + config.leak) / (1.0 + config.leak) : last.gain;
  curve.bias = (s.reference - curve.gain * s.raw) / (s.weights * (1.0 + config.leak));
  return curve;
}

/// The affine curve from one starting point, through all widths of the loss.
GreyCurve affine_from(std::span<const GreyPair> pairs, GreyCurve curve, bool gain_too,
                      const PhotometricConfig& config) {
  for (const double width : kLossWidths)
    curve = affine_round(pairs, curve, std::max(width, config.loss_grey), gain_too, config);
  return curve;
}

double robust_cost(std::span<const GreyPair> pairs, const GreyCurve& curve, double width) {
  double cost = 0.0;
  for (const GreyPair& pair : pairs) {
    const double u2 = std::pow(std::min(std::abs(pair.reference - curve(pair.current)) / width, 1.0), 2);
    cost += 1.0 - std::pow(1.0 - u2, 3);
  }
  return cost;
}

/// Where most pairs agree: from the curve before, and, for a jump of the gain control, from the line that takes the
/// quartiles to each other.
GreyCurve best_affine(std::span<const GreyPair> pairs, const GreyCurve& before, bool gain_too,
                      const PhotometricConfig& config) {
  std::vector<float> current, reference;
  for (const GreyPair& pair : pairs) {
    current.push_back(pair.current);
    reference.push_back(pair.reference);
  }
  std::ranges::sort(current);
  std::ranges::sort(reference);
  const auto at = [](const std::vector<float>& sorted, double share) {
    return static_cast<double>(sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))]);
  };
  const double current_width = at(current, 0.75) - at(current, 0.25),
               reference_width = at(reference, 0.75) - at(reference, 0.25);
  GreyCurve quartiles = before;
  if (gain_too && current_width > 1.0)
    quartiles.gain = std::clamp(reference_width / current_width, config.least_gain, config.most_gain);
  quartiles.bias = at(reference, 0.5) - quartiles.gain * at(current, 0.5);
  const GreyCurve a = affine_from(pairs, before, gain_too, config), b = affine_from(pairs, quartiles, gain_too, config);
  return robust_cost(pairs, a, config.loss_grey) <= robust_cost(pairs, b, config.loss_grey) ? a : b;
}

/// Knots where the greys are: at even shares of the inliers.
std::vector<double> knots_for(std::span<const GreyPair> pairs) {
  constexpr std::array<double, 7> shares{0.02, 0.15, 0.32, 0.5, 0.68, 0.85, 0.98};
  std::vector<float> greys;
  for (const GreyPair& pair : pairs) greys.push_back(pair.current);
  std::ranges::sort(greys);
  std::vector<double> knots;
  for (const double share : shares) {
    const double knot = greys[static_cast<std::size_t>(share * static_cast<double>(greys.size() - 1))];
    if (knots.empty() || knot - knots.back() >= 6.0) knots.push_back(knot);
  }
  return knots;
}

/// Slopes that fall below a tenth of the gain are levelled out from the middle knot outwards: greys keep their order.
void keep_increasing(GreyCurve& curve) {
  const std::size_t middle = curve.knots.size() / 2;
  const auto least_step = [&](std::size_t i) { return -0.9 * curve.gain * (curve.knots[i] - curve.knots[i - 1]); };
  for (std::size_t i = middle + 1; i < curve.knots.size(); ++i)
    curve.offsets[i] = std::max(curve.offsets[i], curve.offsets[i - 1] + least_step(i));
  for (std::size_t i = middle; i > 0; --i)
    curve.offsets[i - 1] = std::min(curve.offsets[i - 1], curve.offsets[i] - least_step(i));
}

/// The affine curve with a polyline on it: least squares over the knots, bent as little as the pairs allow.
GreyCurve with_polyline(std::span<const GreyPair> pairs, const GreyCurve& affine, const PhotometricConfig& config) {
  GreyCurve curve = affine;
  curve.knots = knots_for(pairs);
  const auto n = static_cast<Eigen::Index>(curve.knots.size());
  curve.offsets.assign(curve.knots.size(), 0.0);
  if (n < 3) return affine;
  constexpr std::array<double, 4> widths{40.0, 25.0, 16.0, 1.0};
  for (const double width : widths) {
    Eigen::MatrixXd A = 0.01 * Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 1; i + 1 < n; ++i) {
      Eigen::VectorXd bend = Eigen::VectorXd::Zero(n);
      bend.segment<3>(i - 1) << 1.0, -2.0, 1.0;
      A += 0.05 * bend * bend.transpose();
    }
    Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
    for (const GreyPair& pair : pairs) {
      const double w = tukey_weight(pair.reference - curve(pair.current), std::max(width, config.loss_grey));
      if (w == 0.0) continue;
      const OnKnots at = on_knots(curve.knots, pair.current);
      const auto left = static_cast<Eigen::Index>(at.left);
      Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
      row[left] = 1.0 - at.s;
      row[left + 1] = at.s;
      A += w * row * row.transpose();
      b += w * (pair.reference - affine(pair.current)) * row;
    }
    const Eigen::VectorXd x = A.ldlt().solve(b);
    curve.offsets.assign(x.begin(), x.end());
    keep_increasing(curve);
  }
  return curve;
}

/// Whether the polyline differs from the line by more than its own uncertainty and by enough to matter.
bool bends(const GreyCurve& affine, const GreyCurve& bent, const Residuals& residuals,
           const PhotometricConfig& config) {
  if (bent.knots.empty() || residuals.inliers == 0) return false;
  double most = 0.0;
  for (std::size_t i = 0; i < bent.knots.size(); ++i)
    most = std::max(most, std::abs(bent(bent.knots[i]) - affine(bent.knots[i])));
  const double pairs_a_knot = residuals.inliers / static_cast<double>(bent.knots.size());
  return most > std::max(config.least_bend_grey, config.bend_sigmas * residuals.rms_grey / std::sqrt(pairs_a_knot));
}

}  // namespace

double GreyCurve::operator()(double raw) const {
  const double line = gain * raw + bias;
  if (knots.empty()) return line;
  const OnKnots at = on_knots(knots, raw);
  return line + (1.0 - at.s) * offsets[at.left] + at.s * offsets[at.left + 1];
}

cv::Mat corrected(const cv::Mat& raw, const GreyCurve& curve) {
  std::array<float, 256> table{};
  for (std::size_t grey = 0; grey < table.size(); ++grey)
    table[grey] = static_cast<float>(curve(static_cast<double>(grey)));
  cv::Mat image(raw.size(), CV_32FC1);
  for (int v = 0; v < raw.rows; ++v) {
    const auto* in = raw.ptr<std::uint8_t>(v);
    auto* out = image.ptr<float>(v);
    for (int u = 0; u < raw.cols; ++u) out[u] = table[in[u]];
  }
  return image;
}

PhotometricFit fit_grey_curve(std::span<const GreyPair> pairs, const GreyCurve& before,
                              const PhotometricConfig& config) {
  std::vector<GreyPair> usable;
  for (const GreyPair& pair : pairs)
    if (std::isfinite(pair.reference) && pair.current > static_cast<float>(config.dark) &&
        pair.current < static_cast<float>(config.bright))
      usable.push_back(pair);
  PhotometricFit fit{.curve = before, .kind = PhotometricFit::Kind::kept, .pairs = static_cast<int>(usable.size())};
  if (fit.pairs < config.min_pairs) return fit;

  const bool gain_too = spread_of_raw(usable) >= config.min_spread_grey;
  const GreyCurve affine = best_affine(usable, before, gain_too, config);
  const Residuals residuals = residuals_of(usable, affine, config.loss_grey);
  if (affine.gain < config.least_gain || affine.gain > config.most_gain || residuals.inliers < config.min_pairs)
    return fit;
  fit.curve = affine;
  fit.kind = gain_too ? PhotometricFit::Kind::affine : PhotometricFit::Kind::bias;
  fit.inliers = residuals.inliers;
  fit.rms_grey = residuals.rms_grey;
  if (!gain_too || fit.pairs < config.curve_pairs) return fit;

  const GreyCurve bent = with_polyline(usable, affine, config);
  const Residuals bent_residuals = residuals_of(usable, bent, config.loss_grey);
  const double width = 2.5 * config.loss_grey;  // wide enough to hold what a line misses
  if (!bends(affine, bent, bent_residuals, config) ||
      robust_cost(usable, bent, width) >= robust_cost(usable, affine, width))
    return fit;
  return {.curve = bent,
          .kind = PhotometricFit::Kind::curve,
          .pairs = fit.pairs,
          .inliers = bent_residuals.inliers,
          .rms_grey = bent_residuals.rms_grey};
}

}  // namespace pllit
