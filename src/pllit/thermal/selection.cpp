#include "pllit/thermal/selection.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace pllit {

namespace {

using Eigen::Vector2f;

/// Cells that cover an image evenly.
class Cells {
 public:
  Cells(const Camera& camera, int columns, int rows)
      : columns_(columns),
        rows_(rows),
        per_column_(static_cast<float>(columns) / static_cast<float>(camera.width)),
        per_row_(static_cast<float>(rows) / static_cast<float>(camera.height)) {}

  std::size_t count() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }
  std::size_t of(const Vector2f& px) const {
    const int column = std::clamp(static_cast<int>((px.x() + 0.5F) * per_column_), 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>((px.y() + 0.5F) * per_row_), 0, rows_ - 1);
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

 private:
  int columns_, rows_;
  float per_column_, per_row_;
};

class Selection {
 public:
  explicit Selection(const Features& features) : features_(features), taken_(features.points_px.size()) {
    by_score_.resize(taken_.size());
    std::iota(by_score_.begin(), by_score_.end(), 0);
    std::ranges::stable_sort(by_score_, std::greater{}, [&](int i) { return features.scores[index(i)]; });
  }

  const std::vector<int>& by_score() const { return by_score_; }
  bool taken(int i) const { return taken_[index(i)] != 0; }
  void take(int i) { taken_[index(i)] = 1; }

  /// Takes up to `budget` of the candidates (by score), the best of every cell before the second best of any.
  int take_spread(const std::vector<int>& candidates, const Cells& cells, int budget) {
    std::vector<int> rank(candidates.size()), in_cell(cells.count(), 0);
    for (std::size_t i = 0; i < candidates.size(); ++i)
      rank[i] = in_cell[cells.of(features_.points_px[index(candidates[i])])]++;
    std::vector<std::size_t> order(candidates.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return rank[i]; });
    const auto count = std::min(order.size(), static_cast<std::size_t>(std::max(0, budget)));
    for (std::size_t i = 0; i < count; ++i) take(candidates[order[i]]);
    return static_cast<int>(count);
  }

  std::vector<int> indices() const {
    std::vector<int> chosen;
    for (std::size_t i = 0; i < taken_.size(); ++i)
      if (taken_[i] != 0) chosen.push_back(static_cast<int>(i));
    return chosen;
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  const Features& features_;
  std::vector<int> by_score_;
  std::vector<char> taken_;
};

/// Distance of a point from a segment.
float distance_px(const Vector2f& p, const LineSegment& line) {
  const Vector2f along = line.end_px - line.start_px;
  const float share = std::clamp((p - line.start_px).dot(along) / std::max(along.squaredNorm(), 1e-6F), 0.0F, 1.0F);
  return (p - line.start_px - share * along).norm();
}

}  // namespace

std::vector<int> select_features(const Features& features, std::span<const std::optional<FeatureDepth>> depths,
                                 const Camera& camera, const SelectionConfig& config) {
  assert(depths.size() == features.points_px.size() && features.scores.size() == depths.size());
  Selection selection(features);
  const Cells fine(camera, config.near_columns, config.near_rows);
  const Cells coarse(camera, config.empty_columns, config.empty_rows);

  double farthest_m = config.near_m;
  for (const auto& depth : depths)
    if (depth) farthest_m = std::max(farthest_m, depth->range_m);
  std::vector<int> near;
  std::vector<std::vector<int>> intervals(static_cast<std::size_t>(config.intervals));
  for (const int i : selection.by_score()) {
    const auto& depth = depths[static_cast<std::size_t>(i)];
    if (!depth) continue;
    if (depth->range_m <= config.near_m) {
      near.push_back(i);
    } else {
      const double share = (depth->range_m - config.near_m) / (farthest_m - config.near_m);
      const auto interval = static_cast<std::size_t>(share * config.intervals);
      intervals[std::min(interval, intervals.size() - 1)].push_back(i);
    }
  }
  int left = config.count;
  left -= selection.take_spread(near, fine, static_cast<int>(std::lround(config.near_share * config.count)));
  // The emptiest interval first, so that what it does not use goes to the others.
  std::ranges::stable_sort(intervals, {}, &std::vector<int>::size);
  for (std::size_t k = 0; k < intervals.size(); ++k)
    left -= selection.take_spread(intervals[k], coarse, left / static_cast<int>(intervals.size() - k));
  std::erase_if(near, [&](int i) { return selection.taken(i); });
  selection.take_spread(near, fine, left);

  std::vector<char> filled(coarse.count(), 0);
  for (const int i : selection.indices()) filled[coarse.of(features.points_px[static_cast<std::size_t>(i)])] = 1;
  for (const int i : selection.by_score()) {
    char& there = filled[coarse.of(features.points_px[static_cast<std::size_t>(i)])];
    if (there == 0) selection.take(i);
    there = 1;
  }
  for (const LineSegment& line : features.lines) {
    int added = 0;
    for (const int i : selection.by_score()) {
      if (added >= config.line_points) break;
      if (distance_px(features.points_px[static_cast<std::size_t>(i)], line) > static_cast<float>(config.line_px))
        continue;
      ++added;
      selection.take(i);
    }
  }
  return selection.indices();
}

}  // namespace pllit
