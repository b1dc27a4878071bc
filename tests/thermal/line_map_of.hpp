// The line map that a perfect network would give for known segments, cell by cell: models/targets.py says the same in
// Python.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "pllit/thermal/network_maps.hpp"

namespace pllit::test {

struct Segment {
  Eigen::Vector2f a, b;
};

class LineMap {
 public:
  LineMap(int width, int height) : rows_(height / 4), columns_(width / 4), values_(9 * plane(), 0.0F) {}

  MapView view() const { return {.values = values_.data(), .channels = 9, .rows = rows_, .columns = columns_}; }
  float& at(int channel, int row, int column) {
    return values_[static_cast<std::size_t>(channel) * plane() + static_cast<std::size_t>(row * columns_ + column)];
  }

 private:
  std::size_t plane() const { return static_cast<std::size_t>(rows_ * columns_); }
  int rows_, columns_;
  std::vector<float> values_;
};

inline void say_nearest(LineMap& map, int row, int column, std::span<const Segment> segments) {
  constexpr float kAttraction_px = 10.0F;
  const Eigen::Vector2f cell = line_map::centre_px(row, column);
  float nearest = kAttraction_px;
  for (const Segment& s : segments) {
    const float length = (s.b - s.a).norm();
    const Eigen::Vector2f along = (s.b - s.a) / length, across(-along.y(), along.x());
    const float t = along.dot(cell - s.a), off = across.dot(cell - s.a);
    if (t < 0.0F || t > length || std::abs(off) >= nearest) continue;
    nearest = std::abs(off);
    const Eigen::Vector2f to_foot = off > 0.0F ? Eigen::Vector2f(-across) : across;
    const bool forwards = Eigen::Vector2f(-to_foot.y(), to_foot.x()).dot(along) > 0.0F;
    const float ahead = forwards ? length - t : t;
    const auto angle = [](float reach_px) { return std::atan(reach_px / line_map::kEndScale_px); };
    map.at(line_map::attraction, row, column) = 1.0F;
    map.at(line_map::distance, row, column) = nearest;
    map.at(line_map::direction_x, row, column) = to_foot.x();
    map.at(line_map::direction_y, row, column) = to_foot.y();
    map.at(line_map::end_ahead, row, column) = angle(ahead);
    map.at(line_map::end_behind, row, column) = angle(length - ahead);
  }
}

inline LineMap line_map_of(std::span<const Segment> segments, int width, int height) {
  LineMap map(width, height);
  for (int row = 0; row < height / 4; ++row)
    for (int column = 0; column < width / 4; ++column) say_nearest(map, row, column, segments);
  for (const Segment& s : segments)
    for (const Eigen::Vector2f& end : {s.a, s.b}) {
      const int row = static_cast<int>((end.y() + 0.5F) / 4.0F), column = static_cast<int>((end.x() + 0.5F) / 4.0F);
      const Eigen::Vector2f offset = end - line_map::centre_px(row, column);
      map.at(line_map::junction, row, column) = 1.0F;
      map.at(line_map::junction_x, row, column) = offset.x();
      map.at(line_map::junction_y, row, column) = offset.y();
    }
  return map;
}

}  // namespace pllit::test
