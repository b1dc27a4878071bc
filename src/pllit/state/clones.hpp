// Poses of earlier moments that later measurements refer to (stochastic cloning: Roumeliotis and Burdick 2002).
#pragma once

#include <functional>
#include <vector>

#include "pllit/state/iterated_update.hpp"
#include "pllit/state/joint_equations.hpp"

namespace pllit {

/// n poses of I in W as they were estimated; they are considered, not improved (Schmidt 1966), so that what was built
/// on them stays where it is. Errors (theta, p), right perturbation.
struct Clones {
  std::vector<SE3> T_W_I;
  Eigen::MatrixXd with_state{error_index::size, 0};  ///< 18 x 6n: covariance of the state's error with the poses'
  Eigen::MatrixXd covariance{0, 0};                  ///< 6n x 6n: of the poses' errors

  std::size_t size() const { return T_W_I.size(); }
};

/// The present pose as a further one.
void add_clone(Clones& clones, const Estimate& estimate);
void remove_clone(Clones& clones, std::size_t index);
/// The state's error has become `J_now_before` times what it was, plus noise that the poses know nothing of.
void carry(Clones& clones, const Matrix18& J_now_before);
/// (18 + 6n) square.
Eigen::MatrixXd joint_covariance(const Estimate& estimate, const Clones& clones);

/// A sensor's residuals linearised at a state, with the poses where they are.
using LinearizeJoint = std::function<JointEquations(const NavState&)>;

struct JointUpdate {
  Estimate posterior;
  Clones clones;  ///< the same poses; what they share with the posterior
  JointEquations first{}, last{};  ///< at the prior and at the last linearisation point
  int iterations = 0;
  bool converged = false;
};

/// As iterated_update, for measurements that relate the state to earlier poses: the gain is the one of the joint problem
/// and is given to the state alone. Measurements whose cost the steps do not lower return the prior.
JointUpdate iterated_update(const Estimate& prior, const Clones& clones, const LinearizeJoint& linearize,
                            const FilterConfig& config);

}  // namespace pllit
