// Cameras on rigs and lines of a map for tests of what images say.
#pragma once

#include "pllit/sensor/rig.hpp"
#include "pllit/state/line_landmark.hpp"

namespace pllit::test {

/// A thermal camera as in the NTU4DRadLM recordings, with its lens's distortion.
inline Camera thermal_camera() {
  return {.width = 640,
          .height = 512,
          .fx = 457.2,
          .fy = 457.9,
          .cx = 323.1,
          .cy = 242.5,
          .distortion = Camera::Distortion::radtan,
          .k = {-0.25, 0.08, 0.001, -0.0005, 0.0}};
}

/// The fisheye of the Hilti 2022 recordings.
inline Camera fisheye_camera() {
  return {.width = 720,
          .height = 540,
          .fx = 351.314,
          .fy = 351.491,
          .cx = 367.852,
          .cy = 253.840,
          .distortion = Camera::Distortion::equidistant,
          .k = {-0.036967, -0.008918, 0.008913, -0.003769, 0.0}};
}

/// z forward along x of I, x to the right, y down.
inline SE3 camera_ahead() {
  Matrix3d R;
  R << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return pose_from(rotation_from(Eigen::Quaterniond(R)), Vector3d(0.08, 0.03, -0.05));
}

inline bool in_image(const Eigen::Vector2d& px, const Camera& camera) {
  return px.x() >= 0.0 && px.y() >= 0.0 && px.x() <= camera.width - 1.0 && px.y() <= camera.height - 1.0;
}

/// The landmark of a segment whose ends are known to sigma_m across it.
inline LineLandmark landmark_between(const Vector3d& a_W, const Vector3d& b_W, double sigma_m) {
  LineLandmark line;
  line.axis = Line3::through(a_W, b_W - a_W);
  line.centroid = 0.5 * (a_W + b_W);
  line.half_length_m = 0.5 * (b_W - a_W).norm();
  const Vector3d& d = line.axis.direction;
  line.u = d.unitOrthogonal();
  line.v = d.cross(line.u);
  line.covariance_m2 = sigma_m * sigma_m * Eigen::Matrix4d::Identity();
  return line;
}

}  // namespace pllit::test
