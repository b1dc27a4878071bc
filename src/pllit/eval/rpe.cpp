#include "pllit/eval/rpe.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "pllit/eval/rotation_error.hpp"
#include "pllit/eval/statistics.hpp"

namespace pllit {
namespace {

constexpr double kTolerance = 0.1;  // of delta; evo's default

/// Metres travelled along the truth up to each pair.
std::vector<double> distances_of(std::span<const PosePair> pairs) {
  std::vector<double> distances_m(pairs.size(), 0.0);
  for (std::size_t i = 1; i < pairs.size(); ++i)
    distances_m[i] = distances_m[i - 1] + (pairs[i].T_W_I.translation() - pairs[i - 1].T_W_I.translation()).norm();
  return distances_m;
}

/// The sample behind `from` whose distance from it is nearest to `delta_m`, the earliest of equals; nothing where the
/// nearest is out of tolerance.
std::optional<std::size_t> partner_of(const std::vector<double>& distances_m, std::size_t from, double delta_m) {
  const double wanted_m = distances_m[from] + delta_m;
  const auto first = distances_m.begin() + static_cast<std::ptrdiff_t>(from) + 1;
  auto nearest = std::lower_bound(first, distances_m.end(), wanted_m);
  if (nearest != first) {
    const auto before = std::lower_bound(first, nearest, *(nearest - 1));
    if (nearest == distances_m.end() || wanted_m - *before <= *nearest - wanted_m) nearest = before;
  }
  if (nearest == distances_m.end() || std::abs(*nearest - wanted_m) > kTolerance * delta_m) return std::nullopt;
  return static_cast<std::size_t>(nearest - distances_m.begin());
}

}  // namespace

RelativeError relative_error(std::span<const PosePair> pairs, double delta_m) {
  const std::vector<double> distances_m = distances_of(pairs);
  std::vector<double> lengths_m, percents, yaws_deg, angles_deg;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto j = partner_of(distances_m, i, delta_m);
    if (!j) continue;
    const PosePair &from = pairs[i], &to = pairs[*j];
    const SE3 E = (from.T_W_I.inverse() * to.T_W_I).inverse() * (from.T_V_I.inverse() * to.T_V_I);
    const SO3 R_W_I = to.T_W_I.asSO3();
    lengths_m.push_back(E.translation().norm());
    percents.push_back(100.0 * lengths_m.back() / (distances_m[*j] - distances_m[i]));
    yaws_deg.push_back(yaw_deg(R_W_I * E.asSO3() * R_W_I.inverse()));
    angles_deg.push_back(angle_deg(E.asSO3()));
  }
  return {delta_m,
          lengths_m.size(),
          statistics_of(lengths_m).rmse,
          statistics_of(percents).rmse,
          statistics_of(yaws_deg).rmse,
          statistics_of(angles_deg).rmse};
}

}  // namespace pllit
