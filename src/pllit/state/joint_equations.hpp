// The say of a sensor that relates the present state to earlier poses.
#pragma once

#include <Eigen/Core>

#include "pllit/state/nav_state.hpp"

namespace pllit {

/// As NormalEquations, over the errors of the state (error_index) and then those of n earlier poses, six each (theta,
/// p; right perturbation): H = J'WJ and b = -J'Wr of size 18 + 6 n.
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

/// The normalised innovation squared of an update, in its two parts, each over its mean: near 1 where prior, model and
/// noise agree. `misfit`: of the residuals that no state explains (a bad image); `correction`: how far the sensor wants
/// the state from where the prior has it, in the prior's own metric (a wrong extrinsic or delay, which a thousand
/// residuals would drown).
struct Innovation {
  double misfit = 1.0, correction = 1.0;
};

/// `at_end`: linearised where the update ended, `moved`: the errors from the prior to there, `prior`: (18 + 6n) square
/// covariance.
Innovation innovation(const JointEquations& at_end, const Eigen::VectorXd& moved, const Eigen::MatrixXd& prior);

}  // namespace pllit
