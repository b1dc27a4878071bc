#include "pllit/loop/column_search.hpp"

#include <algorithm>
#include <cmath>

namespace pllit {
namespace {

constexpr float sigma_m = 0.6F;  // of a column's nearness

struct Trial {
  PlanePose T_a_b;
  double score = 0.0;
};

/// The best of a grid of motions around a centre; all of them go to `each`.
template <class Each>
Trial best_of(const ColumnField& a, const std::vector<Column>& b, const SearchWindow& window, double step_m,
              double step_rad, const Each& each) {
  const auto steps = [](double reach, double step) { return static_cast<int>(std::ceil(reach / step - 1e-9)); };
  const int shifts = steps(window.reach_m, step_m), turns = steps(window.reach_rad, step_rad);
  std::vector<Eigen::Vector2f> turned(b.size());
  Trial best{window.centre, -1.0};
  for (int turn = -turns; turn <= turns; ++turn) {
    const double yaw = window.centre.yaw_rad + turn * step_rad;
    const Eigen::Rotation2Df R(static_cast<float>(yaw));
    for (std::size_t i = 0; i < b.size(); ++i) turned[i] = R * b[i].centre_H;
    for (int y = -shifts; y <= shifts; ++y)
      for (int x = -shifts; x <= shifts; ++x) {
        const Eigen::Vector2d t = window.centre.t_m + step_m * Eigen::Vector2d(x, y);
        const Eigen::Vector2f shift = t.cast<float>();
        float sum = 0.0F;
        for (const Eigen::Vector2f& p : turned) sum += a.at(p + shift);
        const Trial trial{{t, yaw}, static_cast<double>(sum) / static_cast<double>(b.size())};
        each(trial);
        if (trial.score > best.score) best = trial;
      }
  }
  return best;
}

}  // namespace

ColumnField::ColumnField(const std::vector<Column>& columns) : values_(static_cast<std::size_t>(size) * size, 0.0F) {
  constexpr int reach = 3;  // cells
  for (const Column& column : columns) {
    const Eigen::Vector2i middle = ((column.centre_H.array() + reach_m) / cell_m).floor().cast<int>();
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const Eigen::Vector2i cell = middle + Eigen::Vector2i(x, y);
        if ((cell.array() < 0).any() || (cell.array() >= size).any()) continue;
        const float distance2 = cell_m * cell_m * static_cast<float>(x * x + y * y);
        float& value = values_[index(cell)];
        value = std::max(value, std::exp(-0.5F * distance2 / (sigma_m * sigma_m)));
      }
  }
}

ColumnMatch search(const ColumnField& a, const std::vector<Column>& b, const SearchWindow& window) {
  constexpr double coarse_m = 1.0, coarse_rad = 0.035, fine_m = 0.25, fine_rad = 0.01;
  constexpr double apart_m = 3.0, apart_rad = 0.14;
  if (b.empty()) return {window.centre, 0.0, 0.0};
  std::vector<Trial> trials;
  const Trial coarse =
      best_of(a, b, window, coarse_m, coarse_rad, [&](const Trial& trial) { trials.push_back(trial); });
  double runner_up = 0.0;
  for (const Trial& trial : trials)
    if ((trial.T_a_b.t_m - coarse.T_a_b.t_m).norm() > apart_m ||
        std::abs(trial.T_a_b.yaw_rad - coarse.T_a_b.yaw_rad) > apart_rad)
      runner_up = std::max(runner_up, trial.score);
  const SearchWindow around{coarse.T_a_b, 0.5 * coarse_m, 0.5 * coarse_rad};
  const Trial fine = best_of(a, b, around, fine_m, fine_rad, [](const Trial&) {});
  return {fine.T_a_b, fine.score, runner_up};
}

double overlap(const ColumnField& a, const std::vector<Column>& b, const PlanePose& T_a_b, double radius_m) {
  const float near = std::exp(-0.5F * 0.5F / (sigma_m * sigma_m));  // half a metre along both axes
  const Eigen::Rotation2Df R(static_cast<float>(T_a_b.yaw_rad));
  const Eigen::Vector2f t = T_a_b.t_m.cast<float>();
  int looked_at = 0, met = 0;
  for (const Column& column : b) {
    if (column.centre_H.norm() > radius_m) continue;
    ++looked_at;
    if (a.at(R * column.centre_H + t) >= 0.99F * near) ++met;
  }
  return looked_at > 0 ? static_cast<double>(met) / looked_at : 0.0;
}

}  // namespace pllit
