#include "pllit/thermal/reprojection.hpp"

#include <Eigen/LU>
#include <cassert>
#include <cmath>

namespace pllit {

namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Matrix3x6 = Eigen::Matrix<double, 3, 6>;

/// An observed end point: where it lies on the plane z = 1, and how a step there moves the pixel.
struct EndPoint {
  Vector3d s;
  Matrix2d J_pixel_s;
};

std::optional<EndPoint> undistorted(const Vector2d& pixel_px, const Camera& camera) {
  constexpr double least_z = 0.087;  // of the unit ray: 85 degrees
  const Vector3d ray = camera.ray(pixel_px);
  if (!(ray.z() > least_z)) return std::nullopt;
  const Vector3d s = ray / ray.z();
  const auto projection = camera.project_with_slope(s);
  if (!projection) return std::nullopt;
  return EndPoint{s, projection->J_pixel_point.leftCols<2>()};
}

/// The line of the paper's Pluecker coordinates seen from a pose: normal n_C of the plane through camera and line.
struct InterpretationPlane {
  Vector3d n_C;
  Matrix3x6 J_n_pose, J_n_keyframe, J_n_camera;
  Eigen::Matrix<double, 3, 4> J_n_line;
};

InterpretationPlane interpretation_plane(const SE3& T_W_I, const SE3& T_W_I_keyframe, const LineLandmark& line_K,
                                         const SE3& T_I_C) {
  const SE3 T_W_K = T_W_I_keyframe * T_I_C;
  const LineLandmark line = T_W_K * line_K;
  const Matrix3d R_I_W = T_W_I.rotation().transpose(), R_C_I = T_I_C.rotation().transpose();
  const Matrix3d R_C_W = R_C_I * R_I_W;
  const Vector3d& d = line.axis.direction;
  const Vector3d camera_W = T_W_I.act(T_I_C.translation());
  const Vector3d m = line.axis.moment - camera_W.cross(d);  // moment about the camera
  InterpretationPlane plane;
  plane.n_C = R_C_W * m;
  plane.J_n_pose << R_C_I * (skew(R_I_W * m) - skew(R_I_W * d) * skew(T_I_C.translation())), R_C_W * skew(d);
  // The line turns with its keyframe about the one place, and with the camera that saw it there about the other.
  const auto turned_about = [&](const Vector3d& p_W) -> Matrix3d {
    return -R_C_W * (skew(line.axis.moment - p_W.cross(d)) + skew(p_W - camera_W) * skew(d));
  };
  const Matrix3d R_W_KI = T_W_I_keyframe.rotation(), shifted = -R_C_W * skew(d);
  plane.J_n_keyframe << turned_about(T_W_I_keyframe.translation()) * R_W_KI, shifted;
  plane.J_n_camera << skew(plane.n_C) + turned_about(T_W_K.translation()) * T_W_K.rotation(),
      R_C_I * skew(R_I_W * d) + shifted * R_W_KI;
  // Shifts of both ends move the centre by their mean and turn the direction by their difference over the length.
  const Vector3d from_camera = line.centroid - camera_W;
  for (int i = 0; i < 4; ++i) {
    const Vector3d shift = i % 2 == 0 ? line.u : line.v;
    const double turn = (i < 2 ? -0.5 : 0.5) / line.half_length_m;
    plane.J_n_line.col(i) = R_C_W * (0.5 * shift.cross(d) + turn * from_camera.cross(shift));
  }
  return plane;
}

/// Distance in pixels of an end point from the projected line n, and its derivative to n.
struct Distance {
  double px;
  Eigen::RowVector3d J_px_n;
  Vector2d normal;  ///< unit, of the projected line in pixels
};

Distance distance_from(const EndPoint& end, const Vector3d& n_C) {
  const Matrix2d to_pixels = end.J_pixel_s.inverse().transpose();
  const Vector2d l = to_pixels * n_C.head<2>();
  const double rho = l.norm();
  const double px = end.s.dot(n_C) / rho;
  Eigen::RowVector3d J = end.s.transpose() / rho;
  J.head<2>() -= px / (rho * rho) * (l.transpose() * to_pixels);
  return {px, J, l / rho};
}

}  // namespace

std::optional<ImageResidual> point_residual(const SE3& T_W_I, const SE3& T_W_I_keyframe,
                                            const PointObservation& observation, const CameraMount& mount,
                                            const Camera& camera) {
  const SE3& T_I_C = mount.T_I_C;
  const Matrix3d R_I_W = T_W_I.rotation().transpose(), R_C_I = T_I_C.rotation().transpose();
  const Matrix3d R_W_K = T_W_I_keyframe.rotation();
  const Vector3d p_K = (1.0 + mount.depth_stretch) * observation.p_K_m;
  const Vector3d point_K = T_I_C.act(p_K);  // in I of the keyframe
  const Vector3d point_I = R_I_W * (R_W_K * point_K + (T_W_I_keyframe.translation() - T_W_I.translation()));
  const Vector3d point_C = R_C_I * (point_I - T_I_C.translation());
  const auto projection = camera.project_with_slope(point_C);
  if (!projection) return std::nullopt;

  const Eigen::Matrix<double, 2, 3>& J_pixel_C = projection->J_pixel_point;
  const Eigen::Matrix<double, 2, 3> J_pixel_I = J_pixel_C * R_C_I;
  const Eigen::Matrix<double, 2, 3> J_pixel_W = J_pixel_I * R_I_W;
  ImageResidual residual;
  residual.r_px = observation.observed_px - projection->pixel_px;
  residual.J_now << -J_pixel_I * skew(point_I), J_pixel_W;
  residual.J_keyframe << J_pixel_W * R_W_K * skew(point_K), -J_pixel_W;
  const Matrix3d R_I_K = R_I_W * R_W_K, R_C_K = R_C_I * R_I_K * T_I_C.rotation();
  residual.J_camera << -J_pixel_C * (skew(point_C) - R_C_K * skew(p_K)), -J_pixel_I * (R_I_K - Matrix3d::Identity());
  const Eigen::Matrix<double, 2, 3> J_pixel_K = J_pixel_C * R_C_K;
  residual.J_depth = -J_pixel_K * observation.p_K_m;
  const Vector2d per_sigma = J_pixel_K * p_K.normalized() * observation.sigma_ray_m;
  residual.model_px2 = per_sigma * per_sigma.transpose();
  return residual;
}

std::optional<LineResidual> line_residual(const SE3& T_W_I, const SE3& T_W_I_keyframe,
                                          const LineObservation& observation, const SE3& T_I_C, const Camera& camera) {
  assert(observation.line_K.half_length_m > 0.0);
  const auto start = undistorted(observation.start_px, camera);
  const auto end = undistorted(observation.end_px, camera);
  if (!start || !end) return std::nullopt;
  const InterpretationPlane plane = interpretation_plane(T_W_I, T_W_I_keyframe, observation.line_K, T_I_C);
  constexpr double least_distance_m = 1e-3;  // the length of the moment: a camera on the line itself sees no plane
  const double distance_m = plane.n_C.norm(), sin_plane = plane.n_C.head<2>().norm() / distance_m;
  if (!(distance_m > least_distance_m) || !(sin_plane > 1e-6)) return std::nullopt;

  const Distance distances[] = {distance_from(*start, plane.n_C), distance_from(*end, plane.n_C)};
  LineResidual line{.residual = {}, .J_line = {}, .sin_plane = sin_plane};
  for (int i = 0; i < 2; ++i) {
    line.residual.r_px[i] = distances[i].px;
    line.residual.J_now.row(i) = distances[i].J_px_n * plane.J_n_pose;
    line.residual.J_keyframe.row(i) = distances[i].J_px_n * plane.J_n_keyframe;
    line.residual.J_camera.row(i) = distances[i].J_px_n * plane.J_n_camera;
    line.J_line.row(i) = distances[i].J_px_n * plane.J_n_line;
  }
  const Vector2d along = (observation.end_px - observation.start_px).normalized();
  line.sin_turn = std::abs(along.dot((distances[0].normal + distances[1].normal).normalized()));
  // A line of the map errs the same way in every image that it is seen in. The k-th of them may say the k^2-th part of
  // what the line's doubt allows, so that all of them together say no more than pi^2 / 6 times as much.
  const double k = std::max(1, observation.line_K.sightings);
  line.residual.model_px2 = k * k * line.J_line * observation.line_K.covariance_m2 * line.J_line.transpose();
  return line;
}

}  // namespace pllit
