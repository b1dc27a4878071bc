// A sensor's whole say in an update.
#pragma once

#include "pllit/state/nav_state.hpp"

namespace pllit {

/// Sums over a sensor's residuals r with Jacobian J (dr/d error) and weight W: H = J'WJ, b = -J'Wr, so that H dx = b is
/// the Gauss-Newton step. Two sensors are combined by adding.
struct NormalEquations {
  Matrix18 H = Matrix18::Zero();
  Vector18 b = Vector18::Zero();
  double cost = 0.0;        ///< sum of robust squared, whitened residuals
  double squared_m2 = 0.0;  ///< sum of squared residuals of the inliers, not whitened
  int candidates = 0;       ///< residuals that were tried
  int inliers = 0;          ///< residuals that count
  /// Directions of the error state (orthonormal columns) that the sensor does not observe: an update leaves them, mean
  /// and covariance, to the prior, although noise in H may say something about them.
  Eigen::Matrix<double, error_index::size, Eigen::Dynamic> unobserved{error_index::size, 0};

  NormalEquations& operator+=(const NormalEquations& other) {
    H += other.H;
    b += other.b;
    cost += other.cost;
    squared_m2 += other.squared_m2;
    candidates += other.candidates;
    inliers += other.inliers;
    return *this;
  }
};

}  // namespace pllit
