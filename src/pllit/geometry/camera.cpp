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

/// d(radtan)/dm.
Eigen::Matrix2d radtan_slope(const std::array<double, 5>& k, const Vector2d& m) {
  const double x = m.x(), y = m.y(), r2 = m.squaredNorm();
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double radial_slope = k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[4]);  // to r2
  const double mixed = 2.0 * k[2] * x + 2.0 * k[3] * y;
  Eigen::Matrix2d slope;
  slope << 2.0 * k[2] * y + 6.0 * k[3] * x, mixed, mixed, 6.0 * k[2] * y + 2.0 * k[3] * x;
  return slope + radial * Eigen::Matrix2d::Identity() + 2.0 * radial_slope * m * m.transpose();
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

std::optional<Camera::Projection> Camera::project_with_slope(const Vector3d& p_C) const {
  const auto pixel = project(p_C);
  if (!pixel) return std::nullopt;
  Eigen::Matrix<double, 2, 3> J;  // of the distorted, normalised coordinates
  if (distortion == Distortion::equidistant) {
    const double r = p_C.head<2>().norm(), range2 = p_C.squaredNorm();
    const Radial radial = equidistant(k, std::atan2(r, p_C.z()));
    const bool on_axis = r < 1e-9 * p_C.z();
    const Vector2d out = on_axis ? Vector2d(Vector2d::Zero()) : Vector2d(p_C.head<2>() / r);
    const double across = on_axis ? 1.0 / p_C.z() : radial.value / r, along = radial.slope * p_C.z() / range2;
    J << across * Eigen::Matrix2d::Identity() + (along - across) * out * out.transpose(),
        -radial.slope * r / range2 * out;
  } else {
    const Vector2d m = p_C.head<2>() / p_C.z();
    const Eigen::Matrix2d slope = radtan_slope(k, m) / p_C.z();
    J << slope, -slope * m;
  }
  J.row(0) *= fx;
  J.row(1) *= fy;
  return Projection{*pixel, J};
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
