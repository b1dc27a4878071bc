// Poses of earlier moments that later measurements refer to (stochastic cloning: Roumeliotis and Burdick 2002).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "pllit/state/iterated_update.hpp"
#include "pllit/state/joint_equations.hpp"

namespace pllit {

/// A camera's mount and the poses at which earlier images were exposed, of I in W. The mount is an unknown as the state
/// is, but for what its covariance takes as known. The poses stay as they were once estimated; they are considered, not
/// improved (Schmidt 1966), so that what was built on them stays where it is.
struct Clones {
  CameraMount mount;
  std::vector<SE3> poses;
  /// Covariances in the order of joint_index: of the state's error with the others', and of those.
  Eigen::MatrixXd with_state = Eigen::MatrixXd::Zero(error_index::size, mount_index::size);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(mount_index::size, mount_index::size);

  std::size_t size() const { return poses.size(); }
  MountMatrix mount_covariance() const { return covariance.topLeftCorner<mount_index::size, mount_index::size>(); }
};

/// No poses yet, and nothing known of the state that would say something of the mount.
Clones without_poses(const CameraMount& mount, const MountMatrix& covariance);
/// A further pose: the exposure of an image at this state.
void add_clone(Clones& clones, const Estimate& estimate, const Exposure& exposed);
void remove_clone(Clones& clones, std::size_t index);
/// The state's error has become `J_now_before` times what it was, plus noise that the others know nothing of.
void carry(Clones& clones, const Matrix18& J_now_before);
/// In the order of joint_index.
Eigen::MatrixXd joint_covariance(const Estimate& estimate, const Clones& clones);

/// A sensor's residuals linearised at a state and a mount.
using LinearizeJoint = std::function<JointEquations(const NavState&, const CameraMount&)>;

struct JointUpdate {
  Estimate posterior;
  Clones clones;                   ///< the mount improved, the poses the same; what they share with the posterior
  JointEquations first{}, last{};  ///< at the prior and at the last linearisation point
  int iterations = 0;
  bool converged = false;
};

/// As iterated_update, for measurements that relate the state to earlier poses: the gain is the one of the joint
/// problem and is given to the state and the mount. Measurements whose cost the steps do not lower return the prior.
JointUpdate iterated_update(const Estimate& prior, const Clones& clones, const LinearizeJoint& linearize,
                            const FilterConfig& config);

}  // namespace pllit
