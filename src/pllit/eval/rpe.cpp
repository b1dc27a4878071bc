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

Vector6 motion_error_V(const PosePair& from, const PosePair& to) {
  const SE3 expected = from.T_V_I * (from.T_W_I.inverse() * to.T_W_I);
  Vector6 error;
  error << log_so3(to.T_V_I.asSO3() * expected.asSO3().inverse()), to.T_V_I.translation() - expected.translation();
  return error;
}

RelativeError relative_error(std::span<const PosePair> pairs, double delta_m) {
  const std::vector<double> distances_m = distances_of(pairs);
  RelativeError error{.delta_m = delta_m};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto j = partner_of(distances_m, i, delta_m);
    if (!j) continue;
    const PosePair &from = pairs[i], &to = pairs[*j];
    const SE3 E = (from.T_W_I.inverse() * to.T_W_I).inverse() * (from.T_V_I.inverse() * to.T_V_I);
    const SO3 R_W_I = to.T_W_I.asSO3();
    const double error_m = E.translation().norm();
    error.samples.push_back({.distance_m = distances_m[i],
                             .error_m = error_m,
                             .percent = 100.0 * error_m / (distances_m[*j] - distances_m[i]),
                             .yaw_deg = yaw_deg(R_W_I * E.asSO3() * R_W_I.inverse()),
                             .rotation_deg = angle_deg(E.asSO3())});
  }
  const auto rmse = [&](double RelativeSample::* figure) {
    std::vector<double> figures;
    for (const RelativeSample& sample : error.samples) figures.push_back(sample.*figure);
    return statistics_of(figures).rmse;
  };
  error.pairs = error.samples.size();
  error.rmse_m = rmse(&RelativeSample::error_m);
  error.percent = rmse(&RelativeSample::percent);
  error.yaw_deg = rmse(&RelativeSample::yaw_deg);
  error.rotation_deg = rmse(&RelativeSample::rotation_deg);
  return error;
}

}  // namespace pllit
