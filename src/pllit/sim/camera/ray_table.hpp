// The rays of a camera model, ready for millions of samples.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pllit/geometry/camera.hpp"

namespace pllit {

/// Unit rays at the corners of all pixels; between them they are interpolated, with an error of the order of 1e-6 rad.
class RayTable {
 public:
  explicit RayTable(const Camera& camera);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Ray in C through the place (right, down) in [0, 1] x [0, 1] inside a pixel; (0.5, 0.5) is its centre. Its length
  /// differs from 1 by about 1e-6.
  Eigen::Vector3f at(int column, int row, float right, float down) const {
    const Eigen::Vector3f* corner =
        &corners_[static_cast<std::size_t>(row) * stride_ + static_cast<std::size_t>(column)];
    const Eigen::Vector3f above = corner[0] + right * (corner[1] - corner[0]);
    const Eigen::Vector3f below = corner[stride_] + right * (corner[stride_ + 1] - corner[stride_]);
    return above + down * (below - above);
  }
  /// Mean angle between the rays of neighbouring pixels near the centre.
  float pixel_rad() const { return pixel_rad_; }

 private:
  int width_, height_;
  std::size_t stride_;
  std::vector<Eigen::Vector3f> corners_;  ///< row by row, (width + 1) x (height + 1)
  float pixel_rad_;
};

}  // namespace pllit
