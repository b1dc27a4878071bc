// What was seen from a stretch of the way, around its middle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pllit/loop/keyframe.hpp"

namespace pllit {

/// An upright thing: a column of half a metre square in which at least three half metres of height are taken. Ground
/// and ceilings are none.
struct Column {
  Eigen::Vector2f centre_H;  ///< m
  int height = 0;            ///< half metres that are taken
};

inline constexpr double kColumn_m = 0.5;

/// Points in H, the level frame of a keyframe: its origin, z up, turned into it by the least rotation.
struct Submap {
  std::vector<Vector3f> points_H;
  std::vector<Column> columns;
};

/// The rotation of I into its level frame.
SO3 levelled(const Vector3d& up_I);

/// Keyframes [first, last] joined along the odometry, in the level frame of `anchor`, thinned out.
Submap make_submap(std::span<const LoopKeyframe> keyframes, std::size_t first, std::size_t last, std::size_t anchor,
                   double voxel_m, double range_m);

/// The columns of a levelled cloud, in a fixed order.
std::vector<Column> columns_of(const std::vector<Vector3f>& points_H);

}  // namespace pllit
