// What the point-line network says about an image; models/pl_net.py and models/targets.py define it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <numbers>

namespace pllit {

/// Planes of floats, one after the other, that something else owns.
struct MapView {
  const float* values = nullptr;
  int channels = 0, rows = 0, columns = 0;

  std::size_t plane() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns); }
  float at(int channel, int row, int column) const {
    return values[static_cast<std::size_t>(channel) * plane() +
                  static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
  }
};

inline constexpr int kDescriptorStride_px = 8;
inline constexpr int kDescriptorSize = 64;

/// The attraction field (after Xue et al., HAWP, 2020): each cell within 10 px of a segment's interior names the
/// nearest point of that segment, its foot, and how far the segment reaches from there.
namespace line_map {
inline constexpr int kStride_px = 4;
inline constexpr int kChannels = 9;
enum Channel : int {
  attraction,  ///< 0 to 1: whether there is a segment near
  distance,    ///< px to the foot
  direction_x,
  direction_y,  ///< towards the foot, of any length
  end_ahead,
  end_behind,  ///< reach t along the quarter turn (x towards y) of the direction, and against it, as atan(t / 16 px)
  junction,    ///< 0 to 1: whether a segment ends in this cell
  junction_x,
  junction_y  ///< where, px from the cell's centre
};
inline constexpr float kEndScale_px = 16.0F;

inline Eigen::Vector2f centre_px(int row, int column) {
  constexpr float kHalf = 0.5F * (kStride_px - 1);
  return {static_cast<float>(column * kStride_px) + kHalf, static_cast<float>(row * kStride_px) + kHalf};
}
}  // namespace line_map

}  // namespace pllit
