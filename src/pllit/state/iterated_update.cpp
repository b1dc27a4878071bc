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

/// Covariance after a gain that leaves the unobserved directions alone (Schmidt 1966; Joseph's form, valid for any
/// gain). `optimal`: covariance after the full gain K = optimal H' R^-1, so that K R K' = optimal (H'R^-1 H) optimal.
Matrix18 after_partial_gain(const Matrix18& prior, const Matrix18& optimal, const NormalEquations& sums) {
  const Matrix18 observed = Matrix18::Identity() - sums.unobserved * sums.unobserved.transpose();
  const Matrix18 kept = Matrix18::Identity() - observed * optimal * sums.H;
  return kept * prior * kept.transpose() + observed * optimal * sums.H * optimal * observed;
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
    Vector18 step = system.solve(P * result.last.b - J * d);
    Matrix18 posterior = system.solve(P);
    if (const auto& unobserved = result.last.unobserved; unobserved.cols() > 0) {
      step -= unobserved * (unobserved.transpose() * (step + d));
      posterior = after_partial_gain(P, posterior, result.last);
    }
    x = boxplus(x, step);

    const Matrix18 L = on_rotation(right_jacobian(step.segment<3>(ix::theta)));
    covariance = L * posterior * L.transpose();
    result.converged = step.segment<3>(ix::theta).norm() < config.rotation_tolerance_rad &&
                       step.segment<3>(ix::p).norm() < config.position_tolerance_m;
  }
  result.posterior.mean = x;
  result.posterior.covariance = 0.5 * (covariance + covariance.transpose());
  return result;
}

}  // namespace pllit
