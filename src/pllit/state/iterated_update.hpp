// The iterated Kalman update in information form (the paper's "Sequential ESIKF"): one function for every sensor.
#pragma once

#include <functional>

#include "pllit/state/normal_equations.hpp"

namespace pllit {

struct FilterConfig {
  int max_iterations = 8;
  double rotation_tolerance_rad = 5e-5;  ///< steps below both tolerances end the iteration
  double position_tolerance_m = 3e-4;
};

/// A sensor's residuals linearised at a state.
using Linearize = std::function<NormalEquations(const NavState&)>;

struct UpdateResult {
  Estimate posterior;
  NormalEquations last;  ///< the sums at the last linearisation point
  /// Error of the posterior by error of the prior: what a third party's errors, correlated with the prior's, go
  /// through.
  Matrix18 J_posterior_prior = Matrix18::Identity();
  int iterations = 0;
  bool converged = false;
};

/// Minimises |x [-] prior|^2 in the prior's metric plus the sensor's cost. The prior is re-projected to the tangent
/// space of each iterate (the right Jacobian of the rotation), and the covariance to that of the result. Directions
/// that the sensor calls unobserved get no gain. A sensor without residuals returns the prior.
UpdateResult iterated_update(const Estimate& prior, const Linearize& linearize, const FilterConfig& config);

}  // namespace pllit
