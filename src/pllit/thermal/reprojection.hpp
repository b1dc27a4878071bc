// Residuals of one point and of one line in an image, with their derivatives and noise.
#pragma once

#include <optional>

#include "pllit/geometry/camera.hpp"
#include "pllit/state/camera_mount.hpp"
#include "pllit/thermal/observations.hpp"

namespace pllit {

using Matrix2x6 = Eigen::Matrix<double, 2, 6>;

/// Two numbers in pixels, observed minus predicted, linear in the errors (theta, p) of poses of I in W.
struct ImageResidual {
  Eigen::Vector2d r_px = Eigen::Vector2d::Zero();
  Matrix2x6 J_now = Matrix2x6::Zero();                  ///< to the pose now
  Matrix2x6 J_keyframe = Matrix2x6::Zero();             ///< to the keyframe's pose
  Matrix2x6 J_camera = Matrix2x6::Zero();               ///< to T_I_C, likewise
  Eigen::Vector2d J_depth = Eigen::Vector2d::Zero();    ///< to the depth stretch
  Eigen::Matrix2d model_px2 = Eigen::Matrix2d::Zero();  ///< covariance that the point's depth or the line brings along
};

/// The paper's reprojection residual, in pixels of the distorted image: the derivative is the distorted model's, so an
/// even noise of the detector stays even. Nothing where the camera does not see the point.
std::optional<ImageResidual> point_residual(const SE3& T_W_I, const SE3& T_W_I_keyframe,
                                            const PointObservation& observation, const CameraMount& mount,
                                            const Camera& camera);

/// How a line lies in an image, beside its residual.
struct LineResidual {
  ImageResidual residual;  ///< of the start and of the end point across the projected line
  Eigen::Matrix<double, 2, 4> J_line = Eigen::Matrix<double, 2, 4>::Zero();  ///< to LineLandmark's four shifts, px/m
  double sin_turn = 0.0;   ///< of the angle between the observed and the projected line
  double sin_plane = 0.0;  ///< of the angle between the plane through camera and line, and the image plane
};

/// The paper's point-to-line residual, in pixels: the end points are undistorted, and the distance is measured with the
/// lens's derivative at each of them. Without distortion it is the paper's s'l / sqrt(l1^2 + l2^2) times the focal
/// length. Nothing where an end point's ray is 85 degrees or more off the axis, or the plane through camera and line is
/// parallel to the image.
std::optional<LineResidual> line_residual(const SE3& T_W_I, const SE3& T_W_I_keyframe,
                                          const LineObservation& observation, const SE3& T_I_C, const Camera& camera);

}  // namespace pllit
