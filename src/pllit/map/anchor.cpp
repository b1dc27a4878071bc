#include "pllit/map/anchor.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "pllit/base/robust.hpp"
#include "pllit/map/anchor_support.hpp"

namespace pllit {
namespace {

/// Value below which a share of them lies.
double quantile(std::vector<float> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

std::vector<float> column(std::span<const AnchorPair> pairs, float AnchorPair::* member) {
  std::vector<float> values;
  for (const AnchorPair& pair : pairs) values.push_back(pair.*member);
  return values;
}

/// How an image sees the map: now = slope * normal + offset, and a polyline over the normal intensities added to it.
struct View {
  double slope = 1.0, offset = 0.0;
  std::vector<double> knots{}, extra{};
};

AnchorCurve inverse(const View& view) {
  AnchorCurve curve{.gain = 1.0 / view.slope, .bias = -view.offset / view.slope};
  for (std::size_t i = 0; i < view.knots.size(); ++i) {
    const double now = view.slope * view.knots[i] + view.offset + view.extra[i];
    curve.knots.push_back(now);
    curve.offsets.push_back(view.knots[i] - curve.gain * now - curve.bias);
  }
  return curve;
}

/// Errors of neighbouring pairs are alike (lens, registration): no more of them count as independent.
constexpr double kIndependent = 300.0;

/// Robust regression of what is seen on what is known, which is the less noisy; its noise is taken out of the spread.
/// The slope is held near the curve's own where the surfaces differ little among themselves.
View line_round(std::span<const AnchorPair> pairs, const AnchorCurve& last, double width, double slope_before,
                double slope_sigma) {
  double w_sum = 0.0, n = 0.0, d = 0.0, squares = 0.0;
  std::vector<double> weights;
  for (const AnchorPair& pair : pairs) {
    const double r = pair.normal - last(pair.now), w = pair.weight * tukey_weight(r, width);
    weights.push_back(w);
    w_sum += w;
    n += w * pair.normal;
    d += w * pair.now;
    squares += w * r * r;
  }
  View view{.slope = 1.0 / last.gain, .offset = -last.bias / last.gain};
  if (w_sum <= 0.0) return view;
  double nn = 0.0, nd = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double dn = pairs[i].normal - n / w_sum;
    nn += weights[i] * (dn * dn - std::min<double>(pairs[i].normal_variance, 0.5 * dn * dn + 1.0));
    nd += weights[i] * dn * (pairs[i].now - d / w_sum);
  }
  const double noise2 = std::max(1.0, squares / w_sum * slope_before * slope_before);
  const double share = std::min(1.0, kIndependent / w_sum);
  const double prior = noise2 / std::pow(slope_sigma * slope_before, 2);
  view.slope = std::clamp((share * nd + prior * slope_before) / (share * std::max(nn, 0.0) + prior), 0.1, 10.0);
  view.offset = (d - view.slope * n) / w_sum;
  return view;
}

/// The polyline of a view: least squares over the knots, bent as little as the pairs allow.
void bend(std::span<const AnchorPair> pairs, const AnchorCurve& last, double width, int count, View& view) {
  const auto normal = column(pairs, &AnchorPair::normal);
  const double low = quantile(normal, 0.01), high = quantile(normal, 0.99);
  if (high - low < 4.0) return;
  for (int i = 0; i < count; ++i) view.knots.push_back(low + (high - low) * i / (count - 1));
  view.extra.assign(view.knots.size(), 0.0);
  const Eigen::Index n = count;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  double total = 0.0;
  for (const AnchorPair& pair : pairs) {
    const double w = pair.weight * tukey_weight(pair.normal - last(pair.now), width);
    if (w <= 0.0) continue;
    const auto [left, s] = on_knots(view.knots, pair.normal);
    const auto i = static_cast<Eigen::Index>(left);
    const double r = pair.now - view.slope * pair.normal - view.offset;
    const Eigen::Vector2d phi(1.0 - s, s);
    A.block<2, 2>(i, i) += w * phi * phi.transpose();
    b.segment<2>(i) += w * r * phi;
    total += w;
  }
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const Eigen::Vector3d second(1.0, -2.0, 1.0);
    A.block<3, 3>(i - 1, i - 1) += 0.01 * total * second * second.transpose();
  }
  A.diagonal().array() += 2e-3 * total + 1e-9;
  Eigen::VectorXd::Map(view.extra.data(), n) = A.ldlt().solve(b);
}

/// Slopes below a tenth of the line's are raised to it, from the middle outwards: brighter stays brighter.
void keep_increasing(View& view) {
  if (view.knots.empty()) return;
  const auto least_step = [&](std::size_t i) { return -0.9 * view.slope * (view.knots[i] - view.knots[i - 1]); };
  const std::size_t middle = view.knots.size() / 2;
  for (std::size_t i = middle + 1; i < view.knots.size(); ++i)
    view.extra[i] = std::max(view.extra[i], view.extra[i - 1] + least_step(i));
  for (std::size_t i = middle; i > 0; --i)
    view.extra[i - 1] = std::min(view.extra[i - 1], view.extra[i] - least_step(i));
}

std::vector<AnchorPair> without_lens(std::span<const AnchorPair> pairs, double lens) {
  std::vector<AnchorPair> corrected(pairs.begin(), pairs.end());
  for (AnchorPair& pair : corrected) pair.now -= static_cast<float>(lens) * pair.radius2;
  return corrected;
}

/// Through what is seen of surfaces alike, in the median: where a search may begin after a jump, and where surfaces
/// come into sight that are darker or brighter than any before, so that the curve so far was a guess there.
AnchorCurve through_medians(std::span<const AnchorPair> pairs, const AnchorCurve& before) {
  constexpr std::size_t kBins = 16, kFewest = 10;
  const std::vector<AnchorPair> flat = without_lens(pairs, before.lens);
  const auto now = column(flat, &AnchorPair::now), normal = column(flat, &AnchorPair::normal);
  const double now_width = quantile(now, 0.85) - quantile(now, 0.15),
               normal_width = quantile(normal, 0.85) - quantile(normal, 0.15);
  View view;
  if (now_width > 1.0 && normal_width > 1.0) view.slope = 1.0 / std::clamp(normal_width / now_width, 0.2, 5.0);
  view.offset = quantile(now, 0.5) - view.slope * quantile(normal, 0.5);

  const double low = quantile(normal, 0.005), high = std::max(low + 1.0, quantile(normal, 0.995));
  std::array<std::vector<AnchorPair>, kBins> bins;
  for (const AnchorPair& pair : flat) {
    const double share = std::clamp((pair.normal - low) / (high - low), 0.0, 0.999);
    bins[static_cast<std::size_t>(share * kBins)].push_back(pair);
  }
  for (const std::vector<AnchorPair>& bin : bins) {
    if (bin.size() < kFewest) continue;
    view.knots.push_back(quantile(column(bin, &AnchorPair::normal), 0.5));
    view.extra.push_back(quantile(column(bin, &AnchorPair::now), 0.5) - view.slope * view.knots.back() - view.offset);
  }
  if (view.knots.size() < 2) view.knots = view.extra = {};
  keep_increasing(view);
  AnchorCurve curve = inverse(view);
  curve.lens = before.lens;
  return curve;
}

/// What is left of the lens in pairs that a curve brings to the map, in the image's unit.
double lens_left(std::span<const AnchorPair> pairs, const AnchorCurve& curve, double width) {
  constexpr double kLensChange = 3.0;  // from image to image, one sigma
  double w_sum = 0.0, q = 0.0, r_sum = 0.0, squares = 0.0, qq = 0.0, qr = 0.0;
  for (const AnchorPair& pair : pairs) {
    const double difference = curve(pair.now) - pair.normal, w = pair.weight * tukey_weight(difference, width);
    const double r = difference / curve.gain;
    w_sum += w;
    q += w * pair.radius2;
    r_sum += w * r;
    squares += w * r * r;
    qq += w * pair.radius2 * pair.radius2;
    qr += w * pair.radius2 * r;
  }
  if (w_sum <= 0.0) return 0.0;
  const double share = std::min(1.0, kIndependent / w_sum), noise2 = std::max(1.0, squares / w_sum);
  return share * (qr - q * r_sum / w_sum) / (share * (qq - q * q / w_sum) + noise2 / (kLensChange * kLensChange));
}

/// From one curve to one that more agrees with, through all widths.
AnchorCurve refined(std::span<const AnchorPair> pairs, AnchorCurve curve, const AnchorConfig& config) {
  constexpr double kSlopeChange = 0.1;  // share that it may change by from image to image, one sigma
  const bool nearly_one = config.slope_sigma > 0.0;
  const double slope_before = nearly_one ? 1.0 : 1.0 / curve.gain,
               slope_sigma = nearly_one ? config.slope_sigma : kSlopeChange;
  double lens = curve.lens;
  curve.lens = 0.0;
  for (const double times : {4.0, 3.0, 2.0, 1.5, 1.0}) {
    const double width = times * config.loss;
    const std::vector<AnchorPair> flat = without_lens(pairs, lens);
    View view = line_round(flat, curve, width, slope_before, slope_sigma);
    if (config.shape == AnchorConfig::Shape::curve && times < 3.5) bend(flat, curve, width, config.knots, view);
    keep_increasing(view);
    curve = inverse(view);
    lens += lens_left(flat, curve, width);
  }
  curve.lens = lens;
  return curve;
}

/// From the median of their sizes.
double spread_of(const std::vector<double>& residuals) {
  constexpr double kGaussian = 1.4826;
  std::vector<float> sizes;
  for (const double r : residuals) sizes.push_back(static_cast<float>(std::abs(r)));
  return kGaussian * quantile(std::move(sizes), 0.5);
}

/// The shift that most pairs agree on.
AnchorCurve shifted(std::span<const AnchorPair> pairs) {
  std::vector<float> differences;
  for (const AnchorPair& pair : pairs) differences.push_back(pair.normal - pair.now);
  return {.gain = 1.0, .bias = quantile(std::move(differences), 0.5)};
}

double robust_cost(std::span<const AnchorPair> pairs, const AnchorCurve& curve, double width) {
  double cost = 0.0;
  for (const AnchorPair& pair : pairs) {
    const double u2 = std::pow(std::min(std::abs(pair.normal - curve(pair.now, pair.radius2)) / width, 1.0), 2);
    cost += static_cast<double>(pair.weight) * (1.0 - std::pow(1.0 - u2, 3));
  }
  return cost;
}

}  // namespace

double squared_radius(const Eigen::Vector2f& pixel_px, const Camera& camera) {
  const Eigen::Vector2d half(0.5 * camera.width, 0.5 * camera.height);
  return (pixel_px.cast<double>() - half).squaredNorm() / half.squaredNorm();
}

double AnchorCurve::operator()(double intensity, double radius2) const {
  intensity -= lens * radius2;
  double value = gain * intensity + bias;
  if (knots.empty()) return value;
  const auto [left, s] = on_knots(knots, intensity);
  return value + (1.0 - s) * offsets[left] + s * offsets[left + 1];
}

double AnchorCurve::doubt(double intensity, double radius2) const {
  intensity -= lens * radius2;
  return slope_doubt * gain * std::max({0.0, low - intensity, intensity - high});
}

std::vector<AnchorPair> anchor_pairs(const ThermalMap& map, const std::vector<SurfaceObservation>& observations,
                                     const Camera& camera) {
  constexpr std::uint32_t kFewest = 3;
  const VoxelModelConfig& model = map.config().model;
  const auto learned_after = static_cast<float>(model.learned_after);
  std::vector<AnchorPair> pairs;
  for (const SurfaceObservation& observation : observations) {
    const ThermalVoxel* voxel = map.find(map.key_at(observation.p_W));
    if (!voxel || voxel->images < kFewest) continue;
    // What has lately looked unusual ties the image less and less; at first it may be the curve that is wrong.
    const float known = std::min(static_cast<float>(voxel->images), learned_after) / learned_after,
                usual = 1.0F / (1.0F + static_cast<float>(voxel->changes)),
                doubt = std::hypot(voxel->doubt, voxel->saturated * static_cast<float>(model.saturated_doubt)) /
                        static_cast<float>(model.noise);
    pairs.push_back({.now = observation.intensity,
                     .normal = voxel->mean,
                     .radius2 = static_cast<float>(squared_radius(observation.pixel_px, camera)),
                     .normal_variance = voxel->variance(model) / static_cast<float>(voxel->images),
                     .weight = known * usual,
                     .trust = 1.0F / (1.0F + doubt * doubt)});
  }
  return pairs;
}

AnchorFit anchor_curve(std::span<const AnchorPair> pairs, const AnchorCurve& before, const AnchorConfig& config) {
  AnchorFit fit{.curve = before, .pairs = static_cast<int>(pairs.size())};
  if (fit.pairs < config.min_pairs) return fit;
  AnchorCurve curve;
  if (config.shape == AnchorConfig::Shape::bias) {
    curve = shifted(pairs);
  } else {
    const AnchorCurve a = refined(pairs, before, config), b = refined(pairs, through_medians(pairs, before), config);
    curve = robust_cost(pairs, a, config.loss) <= 1.1 * robust_cost(pairs, b, config.loss) ? a : b;
  }
  std::vector<double> residuals;
  for (const AnchorPair& pair : pairs) residuals.push_back(pair.normal - curve(pair.now, pair.radius2));
  double squares = 0.0;
  for (const double r : residuals) {
    if (std::abs(r) >= config.loss) continue;
    ++fit.inliers;
    squares += r * r;
  }
  fit.spread = spread_of(residuals);
  fit.rms = fit.inliers > 0 ? std::sqrt(squares / fit.inliers) : 0.0;
  fit.holds = fit.inliers >= config.min_pairs && fit.inliers >= config.min_share * fit.pairs;
  if (!fit.holds) return fit;
  note_support(pairs, residuals, config, curve);
  fit.curve = std::move(curve);
  return fit;
}

}  // namespace pllit
