#include "pllit/map/anchor_support.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

namespace pllit {
namespace {

/// Weights of pairs by the intensity that they are seen with.
struct Agreement {
  double agreeing = 0.0, all = 0.0;
};

/// The intensities around those that most pairs agree on, up to where more than a few contradict the curve, and fewer
/// agree.
std::pair<double, double> undisputed(const std::map<int, Agreement>& bins, double bin_width) {
  constexpr double kFew = 0.01, kInfinity = std::numeric_limits<double>::infinity();
  double total = 0.0;
  for (const auto& [bin, weights] : bins) total += weights.all;
  const auto most = std::ranges::max_element(bins, {}, [](const auto& bin) { return bin.second.agreeing; });
  const auto disputed = [total](const auto& bin) {
    const Agreement& weights = bin.second;
    return weights.agreeing < 0.4 * weights.all && weights.all - weights.agreeing > kFew * total;
  };
  const auto above = std::find_if(std::next(most), bins.end(), disputed);
  const auto below = std::find_if(std::reverse_iterator(most), bins.rend(), disputed);
  return {below == bins.rend() ? -kInfinity : bin_width * (below->first + 1),
          above == bins.end() ? kInfinity : bin_width * above->first};
}

}  // namespace

void note_support(std::span<const AnchorPair> pairs, const std::vector<double>& residuals, const AnchorConfig& config,
                  AnchorCurve& curve) {
  constexpr double kEnds = 0.01;
  const double bin_width = config.loss / curve.gain;
  std::vector<std::pair<double, double>> agreeing;  // intensity without the lens, weight
  std::map<int, Agreement> bins;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const AnchorPair& pair = pairs[i];
    const double now = pair.now - curve.lens * pair.radius2;
    const auto weight = static_cast<double>(pair.weight * pair.trust);
    Agreement& bin = bins[static_cast<int>(std::floor(now / bin_width))];
    bin.all += weight;
    if (std::abs(residuals[i]) >= config.loss) continue;
    bin.agreeing += weight;
    agreeing.emplace_back(now, weight);
  }
  if (agreeing.empty()) return;
  const auto [from, to] = undisputed(bins, bin_width);
  std::erase_if(agreeing, [&](const auto& pair) { return pair.first < from || pair.first > to; });
  std::ranges::sort(agreeing);
  double total = 0.0;
  for (const auto& pair : agreeing) total += pair.second;
  const auto end = [&](auto begin, auto stop) {
    double sum = 0.0;
    while (begin + 1 != stop && (sum += begin->second) < kEnds * total) ++begin;
    return begin->first;
  };
  curve.low = end(agreeing.begin(), agreeing.end());
  curve.high = end(agreeing.rbegin(), agreeing.rend());
  using Shape = AnchorConfig::Shape;
  curve.slope_doubt = config.shape == Shape::curve    ? config.curve_slope_doubt
                      : config.shape == Shape::affine ? config.affine_slope_doubt
                                                      : 0.0;
}

}  // namespace pllit
