#include "pllit/map/anchor.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pllit {
namespace {

double biweight(double residual, double width) {
  const double u = residual / width;
  return std::abs(u) < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
}

/// Where a value lies between knots: weight 1 - s on `left`, s on the one behind it.
struct OnKnots {
  std::size_t left;
  double s;
};

OnKnots on_knots(const std::vector<double>& knots, double value) {
  const auto after = std::ranges::upper_bound(knots, value) - knots.begin();
  const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after, 1, std::ssize(knots) - 1));
  return {i - 1, std::clamp((value - knots[i - 1]) / (knots[i] - knots[i - 1]), 0.0, 1.0)};
}

AnchorCurve line_round(std::span<const AnchorPair> pairs, const AnchorCurve& last, double width, bool gain_too) {
  double w_sum = 0.0, x = 0.0, xx = 0.0, y = 0.0, xy = 0.0;
  for (const AnchorPair& pair : pairs) {
    const double w = static_cast<double>(pair.weight) * biweight(pair.normal - last(pair.now), width), now = pair.now;
    w_sum += w;
    x += w * now;
    xx += w * now * now;
    y += w * pair.normal;
    xy += w * now * pair.normal;
  }
  if (w_sum <= 0.0) return last;
  const double spread = xx - x * x / w_sum;
  AnchorCurve line{.gain = last.gain, .bias = 0.0, .knots = {}, .offsets = {}};
  if (gain_too && spread > w_sum) line.gain = std::clamp((xy - x * y / w_sum) / spread, 0.1, 10.0);
  line.bias = (y - line.gain * x) / w_sum;
  return line;
}

AnchorCurve line_from(std::span<const AnchorPair> pairs, AnchorCurve curve, const AnchorConfig& config) {
  for (const double times : {4.0, 3.0, 2.0, 1.5})
    curve = line_round(pairs, curve, times * config.loss, config.shape != AnchorConfig::Shape::bias);
  return curve;
}

double robust_cost(std::span<const AnchorPair> pairs, const AnchorCurve& curve, double width) {
  double cost = 0.0;
  for (const AnchorPair& pair : pairs) {
    const double u2 = std::pow(std::min(std::abs(pair.normal - curve(pair.now)) / width, 1.0), 2);
    cost += static_cast<double>(pair.weight) * (1.0 - std::pow(1.0 - u2, 3));
  }
  return cost;
}

AnchorCurve through_quartiles(std::span<const AnchorPair> pairs, const AnchorCurve& before,
                              const AnchorConfig& config) {
  std::vector<float> now, normal;
  for (const AnchorPair& pair : pairs) {
    now.push_back(pair.now);
    normal.push_back(pair.normal);
  }
  std::ranges::sort(now);
  std::ranges::sort(normal);
  const auto at = [](const std::vector<float>& sorted, double share) {
    return static_cast<double>(sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))]);
  };
  AnchorCurve line{.gain = before.gain, .bias = 0.0, .knots = {}, .offsets = {}};
  const double now_width = at(now, 0.75) - at(now, 0.25), normal_width = at(normal, 0.75) - at(normal, 0.25);
  if (config.shape != AnchorConfig::Shape::bias && now_width > 1.0)
    line.gain = std::clamp(normal_width / now_width, 0.2, 5.0);
  line.bias = at(normal, 0.5) - line.gain * at(now, 0.5);
  return line;
}

/// Knots evenly over the values, without the outermost.
std::vector<double> knots_over(std::span<const AnchorPair> pairs, int count) {
  std::vector<float> values;
  for (const AnchorPair& pair : pairs) values.push_back(pair.now);
  std::ranges::sort(values);
  const auto last = static_cast<double>(values.size() - 1);
  const double low = values[static_cast<std::size_t>(0.005 * last)],
               high = values[static_cast<std::size_t>(0.995 * last)];
  std::vector<double> knots;
  if (high - low < 1.0) return knots;
  for (int i = 0; i < count; ++i) knots.push_back(low + (high - low) * i / (count - 1));
  return knots;
}

/// One round of the least squares in the polyline's offsets from its line; where pairs are few they bend little.
void polyline_round(std::span<const AnchorPair> pairs, AnchorCurve& curve, double width) {
  const auto n = static_cast<Eigen::Index>(curve.knots.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  double total = 0.0;
  for (const AnchorPair& pair : pairs) {
    const double w = static_cast<double>(pair.weight) * biweight(pair.normal - curve(pair.now), width);
    if (w <= 0.0) continue;
    const auto [left, s] = on_knots(curve.knots, pair.now);
    const auto i = static_cast<Eigen::Index>(left);
    const double r = pair.normal - (curve.gain * pair.now + curve.bias);
    A(i, i) += w * (1.0 - s) * (1.0 - s);
    A(i, i + 1) += w * s * (1.0 - s);
    A(i + 1, i) += w * s * (1.0 - s);
    A(i + 1, i + 1) += w * s * s;
    b[i] += w * (1.0 - s) * r;
    b[i + 1] += w * s * r;
    total += w;
  }
  const double bend_weight = 0.01 * total;
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    Eigen::Vector3d bend(1.0, -2.0, 1.0);
    A.block<3, 3>(i - 1, i - 1) += bend_weight * bend * bend.transpose();
  }
  A.diagonal().array() += 1e-3 * total + 1e-9;
  Eigen::VectorXd::Map(curve.offsets.data(), n) = A.ldlt().solve(b);
}

/// Slopes below a tenth of the gain are raised to it, from the middle outwards.
void keep_increasing(AnchorCurve& curve) {
  const auto least_step = [&](std::size_t i) { return -0.9 * curve.gain * (curve.knots[i] - curve.knots[i - 1]); };
  const std::size_t middle = curve.knots.size() / 2;
  for (std::size_t i = middle + 1; i < curve.knots.size(); ++i)
    curve.offsets[i] = std::max(curve.offsets[i], curve.offsets[i - 1] + least_step(i));
  for (std::size_t i = middle; i > 0; --i)
    curve.offsets[i - 1] = std::min(curve.offsets[i - 1], curve.offsets[i] - least_step(i));
}

AnchorCurve with_polyline(std::span<const AnchorPair> pairs, AnchorCurve curve, const AnchorConfig& config) {
  curve.knots = knots_over(pairs, config.knots);
  curve.offsets.assign(curve.knots.size(), 0.0);
  if (curve.knots.empty()) return curve;
  for (const double times : {3.0, 2.0, 1.5, 1.0, 1.0}) {
    polyline_round(pairs, curve, times * config.loss);
    keep_increasing(curve);
  }
  return curve;
}

}  // namespace

double AnchorCurve::operator()(double intensity) const {
  double value = gain * intensity + bias;
  if (knots.empty()) return value;
  const auto [left, s] = on_knots(knots, intensity);
  return value + (1.0 - s) * offsets[left] + s * offsets[left + 1];
}

std::vector<AnchorPair> anchor_pairs(const ThermalMap& map, const std::vector<SurfaceObservation>& observations) {
  constexpr std::uint32_t kFewest = 3;
  const auto learned_after = static_cast<float>(map.config().model.learned_after);
  std::vector<AnchorPair> pairs;
  for (const SurfaceObservation& observation : observations) {
    const ThermalVoxel* voxel = map.find(map.key_at(observation.p_W));
    if (!voxel || voxel->images < kFewest || voxel->changes > 0) continue;
    pairs.push_back({.now = observation.intensity,
                     .normal = voxel->mean,
                     .weight = std::min(static_cast<float>(voxel->images), learned_after) / learned_after});
  }
  return pairs;
}

AnchorFit anchor_curve(std::span<const AnchorPair> pairs, const AnchorCurve& before, const AnchorConfig& config) {
  AnchorFit fit{.curve = before, .pairs = static_cast<int>(pairs.size())};
  if (fit.pairs < config.min_pairs) return fit;
  const AnchorCurve a = line_from(pairs, before, config),
                    b = line_from(pairs, through_quartiles(pairs, before, config), config);
  AnchorCurve curve = robust_cost(pairs, a, 2.0 * config.loss) <= robust_cost(pairs, b, 2.0 * config.loss) ? a : b;
  if (config.shape == AnchorConfig::Shape::curve) curve = with_polyline(pairs, std::move(curve), config);
  double squares = 0.0;
  for (const AnchorPair& pair : pairs) {
    const double r = pair.normal - curve(pair.now);
    if (std::abs(r) >= config.loss) continue;
    ++fit.inliers;
    squares += r * r;
  }
  fit.rms = fit.inliers > 0 ? std::sqrt(squares / fit.inliers) : 0.0;
  fit.holds = fit.inliers >= config.min_pairs && fit.inliers >= config.min_share * fit.pairs;
  if (fit.holds) fit.curve = std::move(curve);
  return fit;
}

}  // namespace pllit
