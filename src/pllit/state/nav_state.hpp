// The paper's 18 states on their manifold, and the Gaussian around them.
#pragma once

#include <Eigen/Core>

#include "pllit/base/time.hpp"
#include "pllit/geometry/lie.hpp"

namespace pllit {

/// Order of the error state (theta, p, v, b_g, b_a, g), each of three components; declared here only.
namespace error_index {
inline constexpr int theta = 0, p = 3, v = 6, bg = 9, ba = 12, g = 15, size = 18, pose_size = 6;
}

using Vector18 = Eigen::Matrix<double, error_index::size, 1>;
using Matrix18 = Eigen::Matrix<double, error_index::size, error_index::size>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// State x of the paper, eq. (1): orientation, position and velocity of I in W, IMU biases in I, gravity in W.
struct NavState {
  Time time;
  SO3 R_W_I = SO3::Identity();
  Vector3d p_W = Vector3d::Zero();         ///< m
  Vector3d v_W = Vector3d::Zero();         ///< m/s
  Vector3d gyro_bias = Vector3d::Zero();   ///< rad/s
  Vector3d accel_bias = Vector3d::Zero();  ///< m/s2
  Vector3d gravity_W = Vector3d(0.0, 0.0, -9.81);

  SE3 T_W_I() const { return pose_from(R_W_I, p_W); }
};

/// x [+] error: right perturbation R Exp(theta), sums elsewhere. Keeps the time.
NavState boxplus(const NavState& state, const Vector18& error);
/// a [-] b: the error with b [+] error = a.
Vector18 boxminus(const NavState& a, const NavState& b);

/// Mean and covariance of the error state.
struct Estimate {
  NavState mean;
  Matrix18 covariance = Matrix18::Zero();
};

}  // namespace pllit
