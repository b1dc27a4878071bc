#include "pllit/state/joint_equations.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>

namespace pllit {

Innovation innovation(const JointEquations& at_end, const Eigen::VectorXd& moved, const Eigen::MatrixXd& prior) {
  assert(moved.size() == at_end.b.size() && prior.rows() == at_end.b.size());
  if (at_end.inliers == 0) return {};
  // With r0 = r - J moved the innovation, r0' (R + J P J')^-1 r0 is the least of |r0 + J x|^2 over R plus |x|^2 over P,
  // which x = (P^-1 + H)^-1 b attains.
  const Eigen::VectorXd H_moved = at_end.H * moved;
  const Eigen::VectorXd b = at_end.b + H_moved;
  const double squared = at_end.squared + 2.0 * moved.dot(at_end.b) + moved.dot(H_moved);
  const Eigen::PartialPivLU<Eigen::MatrixXd> system(Eigen::MatrixXd::Identity(prior.rows(), prior.cols()) +
                                                    prior * at_end.H);
  const Eigen::VectorXd x = system.solve(prior * b);
  const double correction = x.dot(b - at_end.H * x);  // x' P^-1 x
  // The means of both: b is H times the prior's error and noise of covariance share x H, for what the residuals say was
  // cut, not their noise raised. Without a cut they are expected - tr G and tr G, the numbers that the state fits.
  const Eigen::MatrixXd G = system.solve(prior * at_end.H);
  const double fitted = G.trace(), squares = G.cwiseProduct(G.transpose()).sum(), share = at_end.share;
  const double left = at_end.expected + (1.0 - 2.0 * share) * fitted - (1.0 - share) * squares;
  return {.misfit = (squared - x.dot(b) - correction) / std::max(share, left),
          .correction = correction / (squares + share * (fitted - squares))};
}

}  // namespace pllit
