#include "pllit/geometry/camera.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace pllit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Distorted angle of the equidistant model at angle theta from the axis, and its derivative.
struct Radial {
  double value, slope;
};

Radial equidistant(const std::array<double, 5>& k, double theta) {
  const double t2 = theta * theta;
  const double value = theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  const double slope = 1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
  return {value, slope};
}

/// Radial-tangential distortion of normalised coordinates (Brown 1966, as OpenCV writes it).
Vector2d radtan(const std::array<double, 5>& k, const Vector2d& m) {
  const double r2 = m.squaredNorm(), xy = m.x() * m.y();
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  return m * radial + Vector2d(2.0 * k[2] * xy + k[3] * (r2 + 2.0 * m.x() * m.x()),
                               k[2] * (r2 + 2.0 * m.y() * m.y()) + 2.0 * k[3] * xy);
}

/// d(radtan)/dm by central differences: six evaluations, exact enough for Newton.
Eigen::Matrix2d radtan_slope(const std::array<double, 5>& k, const Vector2d& m) {
  constexpr double step = 1e-6;
  Eigen::Matrix2d slope;
  for (int i = 0; i < 2; ++i) {
    const Vector2d d = step * Vector2d::Unit(i);
    slope.col(i) = (radtan(k, m + d) - radtan(k, m - d)) / (2.0 * step);
  }
  return slope;
}

}  // namespace

std::optional<Vector2d> Camera::project(const Vector3d& p_C) const {
  Vector2d m;
  if (distortion == Distortion::equidistant) {
    const double r = p_C.head<2>().norm();
    const double theta = std::atan2(r, p_C.z());
    const Radial radial = equidistant(k, theta);
    if (radial.slope <= 0.0 || radial.value < 0.0) return std::nullopt;
    m = r < 1e-12 ? Vector2d(Vector2d::Zero()) : Vector2d(p_C.head<2>() / r * radial.value);
  } else {
    if (p_C.z() <= 0.0) return std::nullopt;
    const Vector2d undistorted = p_C.head<2>() / p_C.z();
    m = radtan(k, undistorted);
    // Beyond its reach the polynomial turns back, or through the axis to the other side.
    if (radtan_slope(k, undistorted).determinant() <= 0.0 || m.dot(undistorted) < 0.0) return std::nullopt;
  }
  return Vector2d(fx * m.x() + cx, fy * m.y() + cy);
}

Vector3d Camera::ray(const Vector2d& pixel_px) const {
  constexpr int iterations = 20;
  const Vector2d target((pixel_px.x() - cx) / fx, (pixel_px.y() - cy) / fy);
  if (distortion == Distortion::equidistant) {
    const double r = target.norm();
    double theta = r;
    for (int i = 0; i < iterations; ++i) {
      const Radial radial = equidistant(k, theta);
      theta -= (radial.value - r) / radial.slope;
    }
    const Vector2d direction = r < 1e-12 ? Vector2d(Vector2d::Zero()) : Vector2d(target / r);
    return {direction.x() * std::sin(theta), direction.y() * std::sin(theta), std::cos(theta)};
  }
  Vector2d m = target;
  for (int i = 0; i < iterations; ++i) m -= radtan_slope(k, m).inverse() * (radtan(k, m) - target);
  return Vector3d(m.x(), m.y(), 1.0).normalized();
}

}  // namespace pllit
