// Rotations and poses are manif's (right Jacobians, local perturbations); here are the few formulas beside them.
#pragma once

#include <manif/SE3.h>
#include <manif/SO3.h>

#include <Eigen/Core>

namespace pllit {

using SO3 = manif::SO3d;
using SE3 = manif::SE3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

/// [a]x: skew(a) * b = a.cross(b).
inline Matrix3d skew(const Vector3d& a) {
  Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

inline SO3 exp_so3(const Vector3d& phi) { return manif::SO3Tangentd(phi).exp(); }
inline Vector3d log_so3(const SO3& rotation) { return rotation.log().coeffs(); }

/// Right Jacobian of SO(3): Exp(phi + d) ~ Exp(phi) Exp(Jr(phi) d).
inline Matrix3d right_jacobian(const Vector3d& phi) { return manif::SO3Tangentd(phi).rjac(); }
inline Matrix3d right_jacobian_inverse(const Vector3d& phi) { return manif::SO3Tangentd(phi).rjacinv(); }

/// SO3 from a quaternion that may have been rounded in a text file.
inline SO3 rotation_from(const Eigen::Quaterniond& q) { return SO3(q.normalized()); }
inline SE3 pose_from(const SO3& rotation, const Vector3d& translation) { return SE3(translation, rotation); }

}  // namespace pllit
