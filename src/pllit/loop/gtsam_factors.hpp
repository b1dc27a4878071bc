// The graph's measurements as GTSAM's factors; included by .cpp files of loop/ only, for its headers are slow to
// compile.
#pragma once

#include <gtsam/geometry/Pose3.h>
#include <gtsam/navigation/AttitudeFactor.h>
#include <gtsam/nonlinear/NonlinearFactorGraph.h>
#include <gtsam/nonlinear/PriorFactor.h>
#include <gtsam/nonlinear/Values.h>
#include <gtsam/slam/BetweenFactor.h>
#include <tbb/task_arena.h>
#include <Eigen/Eigenvalues>

#include "pllit/loop/pose_graph.hpp"

namespace pllit {

inline gtsam::Pose3 to_gtsam(const SE3& T) { return gtsam::Pose3(gtsam::Rot3(T.quat()), T.translation()); }
inline SE3 from_gtsam(const gtsam::Pose3& T) {
  return pose_from(rotation_from(T.rotation().toQuaternion()), T.translation());
}

inline gtsam::Key key_of(int pose) { return static_cast<gtsam::Key>(pose); }

/// Both perturb on the right, rotation first, so the covariance carries over as it stands.
inline gtsam::BetweenFactor<gtsam::Pose3> between_factor(const RelativePose& measured,
                                                         const gtsam::SharedNoiseModel& noise) {
  return {key_of(measured.from), key_of(measured.to), to_gtsam(measured.T_from_to), noise};
}

/// Sigmas within what a solver in double precision can tell apart: along a corridor whose axis nothing observed they
/// grow to kilometres, next to millimetres across it, and the system is singular to rounding.
inline Matrix6 solvable(const Matrix6& covariance) {
  constexpr double least = 1e-5, most = 10.0;  // rad, m
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(covariance);
  const Vector6 variances = eigen.eigenvalues().cwiseMax(least * least).cwiseMin(most * most);
  return eigen.eigenvectors() * variances.asDiagonal() * eigen.eigenvectors().transpose();
}

inline gtsam::SharedNoiseModel noise_of(const RelativePose& measured, double variance_factor = 1.0) {
  return gtsam::noiseModel::Gaussian::Covariance(variance_factor * solvable(measured.covariance));
}

inline gtsam::Pose3AttitudeFactor vertical_factor(const Upright& vertical) {
  return {key_of(vertical.pose), gtsam::Unit3(0.0, 0.0, 1.0),
          gtsam::noiseModel::Isotropic::Sigma(2, vertical.sigma_rad), gtsam::Unit3(vertical.up_I)};
}

/// Holds the first pose but for its tilt.
inline gtsam::PriorFactor<gtsam::Pose3> first_factor(const SE3& T_M_I, double tilt_sigma_rad) {
  constexpr double fixed = 1e-5;  // rad, m
  const Vector3d sigmas_M(tilt_sigma_rad, tilt_sigma_rad, fixed);
  const Matrix3d R_I_M = T_M_I.rotation().transpose();
  Matrix6 covariance = fixed * fixed * Matrix6::Identity();
  covariance.topLeftCorner<3, 3>() = R_I_M * sigmas_M.cwiseAbs2().asDiagonal() * R_I_M.transpose();
  return {key_of(0), to_gtsam(T_M_I), gtsam::noiseModel::Gaussian::Covariance(covariance)};
}

/// GTSAM sums in an order that depends on its threads; with one the result is the same to the bit.
template <class Work>
auto on_one_thread(const Work& work) {
  tbb::task_arena arena(1);
  return arena.execute(work);
}

}  // namespace pllit
