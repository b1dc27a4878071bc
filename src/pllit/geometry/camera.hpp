// Camera models: pinhole with radial-tangential or equidistant (fisheye) distortion.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace pllit {

/// Intrinsics of one camera. Pixel (0, 0) is the centre of the top left pixel.
struct Camera {
  enum class Distortion { radtan, equidistant };
  int width = 0, height = 0;
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< px
  Distortion distortion = Distortion::radtan;
  std::array<double, 5> k{};  ///< radtan: k1 k2 p1 p2 k3; equidistant: k1 k2 k3 k4 (the fifth unused)

  /// Pixel of a point in the camera frame (z forward), or nothing where the model has none: behind the camera, or
  /// beyond the angle at which the distortion stops growing.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_C) const;
  struct Projection {
    Eigen::Vector2d pixel_px;
    Eigen::Matrix<double, 2, 3> J_pixel_point;  ///< px/m
  };
  /// Likewise, with the derivative.
  std::optional<Projection> project_with_slope(const Eigen::Vector3d& p_C) const;
  /// Unit ray in the camera frame through a pixel; the inverse of project, by Newton iteration.
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel_px) const;
};

}  // namespace pllit
