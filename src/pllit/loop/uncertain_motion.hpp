// Motions with covariance, and how errors add up along a path.
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "pllit/state/nav_state.hpp"

namespace pllit {

/// A motion T_a_b; its error (theta, p) perturbs it on the right, in the frame of b.
struct UncertainMotion {
  SE3 T_a_b;
  Matrix6 covariance = Matrix6::Zero();
};

/// T Exp(e) = Exp(adjoint(T) e) T, in the order (theta, p).
inline Matrix6 adjoint(const SE3& T) {
  const Matrix3d R = T.rotation();
  Matrix6 adjoint = Matrix6::Zero();
  adjoint.topLeftCorner<3, 3>() = R;
  adjoint.bottomRightCorner<3, 3>() = R;
  adjoint.bottomLeftCorner<3, 3>() = skew(T.translation()) * R;
  return adjoint;
}

/// a then b, their errors independent.
inline UncertainMotion operator*(const UncertainMotion& a, const UncertainMotion& b) {
  const Matrix6 back = adjoint(b.T_a_b.inverse());
  return {a.T_a_b * b.T_a_b, back * a.covariance * back.transpose() + b.covariance};
}

inline UncertainMotion inverse(const UncertainMotion& motion) {
  const Matrix6 over = adjoint(motion.T_a_b);
  return {motion.T_a_b.inverse(), over * motion.covariance * over.transpose()};
}

/// The error that turns `predicted` into `measured`: (theta, p) on the right.
inline Vector6 difference(const SE3& predicted, const SE3& measured) {
  const SE3 T = predicted.inverse() * measured;
  Vector6 error;
  error << log_so3(T.asSO3()), T.translation();
  return error;
}

/// Squared difference of two motions in standard deviations of their errors, which are independent.
inline double squared_difference(const UncertainMotion& a, const UncertainMotion& b) {
  const Vector6 error = difference(a.T_a_b, b.T_a_b);
  return error.dot((a.covariance + b.covariance).ldlt().solve(error));
}

/// The odometry from pose to pose; the error between any two of them in constant time.
class OdometryChain {
 public:
  /// The step from the pose before; the first one's pose is where it stands.
  void append(const SE3& T_O_I, const Matrix6& step_covariance) {
    UncertainMotion next{T_O_I, step_covariance};
    if (!from_first_.empty()) {
      const Matrix6 back = adjoint(T_O_I.inverse() * from_first_.back().T_a_b);
      next.covariance += back * from_first_.back().covariance * back.transpose();
    } else {
      next.covariance.setZero();
    }
    from_first_.push_back(next);
  }

  /// Steps are independent, so what `to` has beyond `from` came in between.
  UncertainMotion between(int from, int to) const {
    if (from > to) return inverse(between(to, from));
    const UncertainMotion &a = from_first_[static_cast<std::size_t>(from)],
                          &b = from_first_[static_cast<std::size_t>(to)];
    const SE3 T_a_b = a.T_a_b.inverse() * b.T_a_b;
    const Matrix6 back = adjoint(T_a_b.inverse());
    return {T_a_b, b.covariance - back * a.covariance * back.transpose()};
  }

  int size() const { return static_cast<int>(from_first_.size()); }

 private:
  std::vector<UncertainMotion> from_first_;
};

}  // namespace pllit
