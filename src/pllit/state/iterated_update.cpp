#include "pllit/state/iterated_update.hpp"

#include <Eigen/LU>

namespace pllit {

namespace ix = error_index;

namespace {

/// blkdiag(block, I): how an error moves between two tangent spaces of the manifold.
Matrix18 on_rotation(const Matrix3d& block) {
  Matrix18 m = Matrix18::Identity();
  m.block<3, 3>(ix::theta, ix::theta) = block;
  return m;
}

}  // namespace

UpdateResult iterated_update(const Estimate& prior, const Linearize& linearize, const FilterConfig& config) {
  UpdateResult result{.posterior = prior, .last = {}, .iterations = 0, .converged = false};
  NavState x = prior.mean;
  Matrix18 covariance = prior.covariance;
  while (result.iterations < config.max_iterations && !result.converged) {
    ++result.iterations;
    result.last = linearize(x);
    if (result.last.inliers == 0) return {.posterior = prior, .last = result.last, .iterations = result.iterations};

    const Vector18 d = boxminus(x, prior.mean);
    const Matrix18 J = on_rotation(right_jacobian(d.segment<3>(ix::theta)));
    const Matrix18 P = J * prior.covariance * J.transpose();
    // (P^-1 + H) dx = b - P^-1 J d, multiplied by P from the left so that P need not be inverted.
    const Eigen::PartialPivLU<Matrix18> system(Matrix18::Identity() + P * result.last.H);
    const Vector18 step = system.solve(P * result.last.b - J * d);
    x = boxplus(x, step);

    const Matrix18 L = on_rotation(right_jacobian(step.segment<3>(ix::theta)));
    covariance = L * system.solve(P) * L.transpose();
    result.converged = step.segment<3>(ix::theta).norm() < config.rotation_tolerance_rad &&
                       step.segment<3>(ix::p).norm() < config.position_tolerance_m;
  }
  result.posterior.mean = x;
  result.posterior.covariance = 0.5 * (covariance + covariance.transpose());
  return result;
}

}  // namespace pllit
