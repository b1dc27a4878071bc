// The points of one image by place.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace pllit {

/// Finds points in a box without looking at the others.
class PointIndex {
 public:
  /// Points outside width x height pixels count to the squares at the border.
  PointIndex(std::span<const Eigen::Vector2f> points_px, int width, int height)
      : columns_(width / kSquare_px + 1), rows_(height / kSquare_px + 1) {
    first_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    for (const auto& point : points_px) ++first_[square_of(point) + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    order_.resize(points_px.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < points_px.size(); ++i) order_[next[square_of(points_px[i])]++] = static_cast<int>(i);
  }

  /// Calls visit(index) for the points of all squares that the box from `low` to `high` touches, some of them outside
  /// it.
  template <class Visit>
  void for_box(const Eigen::Vector2f& low, const Eigen::Vector2f& high, const Visit& visit) const {
    const int left = column_of(low.x()), right = column_of(high.x());
    for (int row = row_of(low.y()); row <= row_of(high.y()); ++row) {
      const std::size_t base = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
      const std::size_t begin = first_[base + static_cast<std::size_t>(left)],
                        end = first_[base + static_cast<std::size_t>(right) + 1];
      for (std::size_t i = begin; i < end; ++i) visit(order_[i]);
    }
  }

 private:
  static constexpr int kSquare_px = 16;

  int column_of(float x) const {
    return static_cast<int>(std::clamp(x / kSquare_px, 0.0F, static_cast<float>(columns_ - 1)));
  }
  int row_of(float y) const {
    return static_cast<int>(std::clamp(y / kSquare_px, 0.0F, static_cast<float>(rows_ - 1)));
  }
  std::size_t square_of(const Eigen::Vector2f& point) const {
    return static_cast<std::size_t>(row_of(point.y())) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column_of(point.x()));
  }

  int columns_, rows_;
  std::vector<std::size_t> first_;  ///< in order_, of each square; one more than squares
  std::vector<int> order_;
};

}  // namespace pllit
