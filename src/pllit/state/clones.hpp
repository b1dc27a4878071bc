// Poses of earlier moments that later measurements refer to (stochastic cloning: Roumeliotis and Burdick 2002).
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pllit/state/iterated_update.hpp"
#include "pllit/state/joint_equations.hpp"

namespace pllit {

/// n poses, errors (theta, p), right perturbation. The first `estimated` ones are unknowns as the state is: a sensor's
/// pose on the rig. The others are poses of I in W as they were once estimated; they are considered, not improved
/// (Schmidt 1966), so that what was built on them stays where it is.
struct Clones {
  std::vector<SE3> poses;
  Eigen::MatrixXd with_state{error_index::size, 0};  ///< 18 x 6n: covariance of the state's error with the poses'
  Eigen::MatrixXd covariance{0, 0};                  ///< 6n x 6n: of the poses' errors
  std::size_t estimated = 0;

  std::size_t size() const { return poses.size(); }
};

/// No poses yet but this one, which is to be estimated, with its covariance.
Clones with_unknown(const SE3& pose, const Matrix6& covariance);
/// The present pose as a further one.
void add_clone(Clones& clones, const Estimate& estimate);
void remove_clone(Clones& clones, std::size_t index);
/// The state's error has become `J_now_before` times what it was, plus noise that the poses know nothing of.
void carry(Clones& clones, const Matrix18& J_now_before);
/// (18 + 6n) square.
Eigen::MatrixXd joint_covariance(const Estimate& estimate, const Clones& clones);

/// A sensor's residuals linearised at a state and poses.
using LinearizeJoint = std::function<JointEquations(const NavState&, std::span<const SE3> poses)>;

struct JointUpdate {
  Estimate posterior;
  Clones clones;  ///< the unknown poses improved, the others the same; what they share with the posterior
  JointEquations first{}, last{};  ///< at the prior and at the last linearisation point
  int iterations = 0;
  bool converged = false;
};

/// As iterated_update, for measurements that relate the state to earlier poses: the gain is the one of the joint
/// problem and is given to the state and the unknown poses. Measurements whose cost the steps do not lower return the
/// prior. `along`: orthonormal columns; then the state's gain is kept to them, whatever the sensor says of other
/// directions.
using StateDirections = Eigen::Matrix<double, error_index::size, Eigen::Dynamic>;
JointUpdate iterated_update(const Estimate& prior, const Clones& clones, const LinearizeJoint& linearize,
                            const FilterConfig& config, const std::optional<StateDirections>& along = std::nullopt);

}  // namespace pllit
