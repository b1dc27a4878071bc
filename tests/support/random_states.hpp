// Seeded random values and central differences for tests of Jacobians.
#pragma once

#include <Eigen/Core>
#include <random>

#include "pllit/state/nav_state.hpp"

namespace pllit::test {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(engine_); }
  double normal(double sigma = 1.0) { return sigma * std::normal_distribution()(engine_); }
  Vector3d vector(double sigma = 1.0) { return {normal(sigma), normal(sigma), normal(sigma)}; }
  SO3 rotation() { return exp_so3(vector()); }
  NavState state() {
    NavState x;
    x.R_W_I = rotation();
    x.p_W = vector(5.0);
    x.v_W = vector(2.0);
    x.gyro_bias = vector(0.02);
    x.accel_bias = vector(0.2);
    x.gravity_W = Vector3d(0.0, 0.0, -9.81) + vector(0.05);
    return x;
  }
  /// A random positive definite matrix with standard deviations of about `sigma`.
  Matrix18 covariance(double sigma) {
    const Matrix18 a = Matrix18::NullaryExpr([this] { return normal(); });
    return sigma * sigma * (a * a.transpose() / 18.0 + 0.1 * Matrix18::Identity());
  }
  std::mt19937_64& engine() { return engine_; }

 private:
  std::mt19937_64 engine_;
};

/// Central differences of a vector-valued function of a vector.
template <int Rows, int Cols, class Function>
Eigen::Matrix<double, Rows, Cols> numerical_jacobian(const Function& function, double step = 1e-6) {
  Eigen::Matrix<double, Rows, Cols> J;
  for (int i = 0; i < Cols; ++i) {
    Eigen::Matrix<double, Cols, 1> d = Eigen::Matrix<double, Cols, 1>::Zero();
    d[i] = step;
    J.col(i) = (function(d) - function(Eigen::Matrix<double, Cols, 1>(-d))) / (2.0 * step);
  }
  return J;
}

}  // namespace pllit::test
