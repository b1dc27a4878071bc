// The say of a sensor that relates the present state to earlier poses.
#pragma once

#include <Eigen/Core>

#include "pllit/state/camera_mount.hpp"

namespace pllit {

/// Order of the joint error: the state's (error_index), the camera mount's (mount_index), then those of n earlier
/// poses, six each (theta, p; right perturbation).
namespace joint_index {
inline constexpr int mount = error_index::size, clones = mount + mount_index::size;
constexpr Eigen::Index clone(std::size_t i) { return clones + error_index::pose_size * static_cast<Eigen::Index>(i); }
}  // namespace joint_index

/// As NormalEquations, over the joint error: H = J'WJ and b = -J'Wr.
struct JointEquations {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  double cost = 0.0;      ///< sum of robust squared, whitened residuals
  double squared = 0.0;   ///< r'Wr: sum of squared, whitened residuals times their robust weights
  double expected = 0.0;  ///< mean of `squared` where the residuals are as noisy as they are said to be
  double share = 1.0;     ///< of what the residuals say, if their errors are independent, that all of this is
  int candidates = 0;     ///< residuals that were tried
  int inliers = 0;        ///< residuals that count

  explicit JointEquations(std::size_t poses = 0)
      : H(Eigen::MatrixXd::Zero(joint_index::clone(poses), joint_index::clone(poses))),
        b(Eigen::VectorXd::Zero(joint_index::clone(poses))) {}
};

/// The normalised innovation squared of an update, in its two parts, each over its mean: near 1 where prior, model and
/// noise agree. `misfit`: of the residuals that no state explains (a bad image); `correction`: how far the sensor wants
/// the state from where the prior has it, in the prior's own metric (a wrong extrinsic or delay, which a thousand
/// residuals would drown).
struct Innovation {
  double misfit = 1.0, correction = 1.0;
};

/// `at_end`: linearised where the update ended, `moved`: the errors from the prior to there, `prior`: covariance of
/// the joint error.
Innovation innovation(const JointEquations& at_end, const Eigen::VectorXd& moved, const Eigen::MatrixXd& prior);

}  // namespace pllit
