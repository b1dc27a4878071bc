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

/// Covariance after any gain (Joseph's form). `kept` = I - K H; `gain`: the covariance G with K = G H' R^-1, so that
/// K R K' = G (H'R^-1 H) G'.
Matrix18 after_gain(const Matrix18& prior, const Matrix18& kept, const Matrix18& gain, const Matrix18& H) {
  return kept * prior * kept.transpose() + gain * H * gain.transpose();
}

}  // namespace

UpdateResult iterated_update(const Estimate& prior, const Linearize& linearize, const FilterConfig& config) {
  UpdateResult result{.posterior = prior, .last = {}};
  NavState x = prior.mean;
  Matrix18 covariance = prior.covariance;
  while (result.iterations < config.max_iterations && !result.converged) {
    ++result.iterations;
    result.last = linearize(x);
    if (result.last.inliers == 0) {
      UpdateResult none{.posterior = prior, .last = result.last};
      none.iterations = result.iterations;
      return none;
    }

    const Vector18 d = boxminus(x, prior.mean);
    const Matrix18 J = on_rotation(right_jacobian(d.segment<3>(ix::theta)));
    const Matrix18 P = J * prior.covariance * J.transpose();
    // (P^-1 + H) dx = b - P^-1 J d, multiplied by P from the left so that P need not be inverted.
    const Eigen::PartialPivLU<Matrix18> system(Matrix18::Identity() + P * result.last.H);
    Vector18 step = system.solve(P * result.last.b - J * d);
    Matrix18 posterior = system.solve(P), gain = posterior;
    const auto& unobserved = result.last.unobserved;
    if (unobserved.cols() > 0) {  // directions that get no gain (Schmidt 1966)
      step -= unobserved * (unobserved.transpose() * (step + d));
      gain -= unobserved * (unobserved.transpose() * gain).eval();
    }
    const Matrix18 kept = Matrix18::Identity() - gain * result.last.H;
    if (unobserved.cols() > 0) posterior = after_gain(P, kept, gain, result.last.H);
    x = boxplus(x, step);

    const Matrix18 L = on_rotation(right_jacobian(step.segment<3>(ix::theta)));
    covariance = L * posterior * L.transpose();
    result.J_posterior_prior = L * kept * J;
    result.converged = step.segment<3>(ix::theta).norm() < config.rotation_tolerance_rad &&
                       step.segment<3>(ix::p).norm() < config.position_tolerance_m;
  }
  result.posterior.mean = x;
  result.posterior.covariance = 0.5 * (covariance + covariance.transpose());
  return result;
}

}  // namespace pllit
