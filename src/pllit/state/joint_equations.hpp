// The say of a sensor that relates the present state to earlier poses.
#pragma once

#include <Eigen/Core>

#include "pllit/state/nav_state.hpp"

namespace pllit {

/// As NormalEquations, over the errors of the state (error_index) and then those of n earlier poses, six each (theta, p;
/// right perturbation): H = J'WJ and b = -J'Wr of size 18 + 6 n.
struct JointEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  double cost = 0.0;      ///< sum of robust squared, whitened residuals
  double squared = 0.0;   ///< r'Wr: sum of squared, whitened residuals times their robust weights
  double expected = 0.0;  ///< mean of `squared` where the residuals are as noisy as they are said to be
  int candidates = 0;     ///< residuals that were tried
  int inliers = 0;        ///< residuals that count

  explicit JointEquations(std::size_t poses = 0)
      : H(Eigen::MatrixXd::Zero(size_for(poses), size_for(poses))), b(Eigen::VectorXd::Zero(size_for(poses))) {}
  static Eigen::Index size_for(std::size_t poses) {
    return error_index::size + error_index::pose_size * static_cast<Eigen::Index>(poses);
  }
};

/// Normalised innovation squared over its mean: near 1 where prior, model and noise agree, far above it where a sensor
/// contradicts what is known (a wrong extrinsic, a bad image). `at_end`: linearised where the update ended, `moved`:
/// from the prior to there, `prior`: (18 + 6n) square covariance. 0 without inliers.
double innovation_ratio(const JointEquations& at_end, const Eigen::VectorXd& moved, const Eigen::MatrixXd& prior);

}  // namespace pllit
