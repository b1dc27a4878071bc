#include "pllit/state/joint_equations.hpp"

#include <Eigen/LU>
#include <cassert>

namespace pllit {

double innovation_ratio(const JointEquations& at_end, const Eigen::VectorXd& moved, const Eigen::MatrixXd& prior) {
  assert(moved.size() == at_end.b.size() && prior.rows() == at_end.b.size());
  if (at_end.inliers == 0) return 0.0;
  // The innovation is r - J moved, and by the inversion lemma r'(R + J P J')^-1 r = r'Wr - b'(P^-1 + H)^-1 b.
  const Eigen::VectorXd H_moved = at_end.H * moved;
  const double squared = at_end.squared + 2.0 * moved.dot(at_end.b) + moved.dot(H_moved);
  const Eigen::VectorXd b = at_end.b + H_moved;
  const Eigen::MatrixXd system = Eigen::MatrixXd::Identity(prior.rows(), prior.cols()) + prior * at_end.H;
  const double explained = b.dot(system.partialPivLu().solve(prior * b));
  return (squared - explained) / at_end.expected;
}

}  // namespace pllit
