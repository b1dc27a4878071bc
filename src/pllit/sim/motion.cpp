#include "pllit/sim/motion.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace pllit {
namespace {

constexpr int kOrder = 6;  // quintic: six controls act on each segment
using Polynomial = std::array<double, kOrder>;

constexpr double factorial(int n) { return n < 2 ? 1.0 : n * factorial(n - 1); }
constexpr double choose(int n, int k) { return factorial(n) / (factorial(k) * factorial(n - k)); }
constexpr double power(double base, int exponent) { return exponent == 0 ? 1.0 : base * power(base, exponent - 1); }

/// Coefficient of u^n in the basis function of control s; Sommer et al., equation 7.
constexpr double basis_coefficient(int s, int n) {
  double sum = 0.0;
  for (int l = s; l < kOrder; ++l)
    sum += ((l - s) % 2 ? -1.0 : 1.0) * choose(kOrder, l - s) * power(kOrder - 1 - l, kOrder - 1 - n);
  return choose(kOrder - 1, n) / factorial(kOrder - 1) * sum;
}

/// lambda_j(u): how much of step j has been made at u in [0, 1] of a segment, for j = 1 .. 5.
constexpr std::array<Polynomial, kOrder - 1> cumulative_basis() {
  std::array<Polynomial, kOrder - 1> basis{};
  for (int j = 1; j < kOrder; ++j)
    for (int n = 0; n < kOrder; ++n)
      for (int s = j; s < kOrder; ++s)
        basis[static_cast<std::size_t>(j - 1)][static_cast<std::size_t>(n)] += basis_coefficient(s, n);
  return basis;
}

struct Weight {
  double value = 0.0, rate = 0.0, acceleration = 0.0;  // per 1, per segment, per segment^2
};

Weight weight_at(const Polynomial& lambda, double u) {
  Weight w;
  for (std::size_t n = kOrder; n-- > 0;) {  // Horner's scheme for a polynomial and its derivatives
    w.acceleration = w.acceleration * u + 2.0 * w.rate;
    w.rate = w.rate * u + w.value;
    w.value = w.value * u + lambda[n];
  }
  return w;
}

}  // namespace

Motion::Motion(Time start, Duration spacing, const std::vector<SE3>& controls) : start_(start), spacing_(spacing) {
  assert(controls.size() >= kOrder && spacing > Duration::zero());
  controls_.reserve(controls.size());
  for (std::size_t i = 0; i < controls.size(); ++i) {
    const SE3& before = controls[i == 0 ? 0 : i - 1];
    Control control{controls[i], controls[i].translation() - before.translation(), Vector3d::Zero()};
    if (controls[i].coeffs() !=
        before.coeffs())  // equal rotations, inverted and multiplied, would leave a rounding error
      control.rotation_step = log_so3(before.asSO3().inverse() * controls[i].asSO3());
    controls_.push_back(control);
  }
}

MotionState Motion::at(Time time) const {
  static constexpr auto kBasis = cumulative_basis();
  const Duration elapsed = std::clamp(time, start_, end()) - start_;
  const std::int64_t segment = std::min(elapsed / spacing_, segments() - 1);
  const double dt = to_seconds(spacing_);
  const double u = to_seconds(elapsed - segment * spacing_) / dt;

  const Control* control = &controls_[static_cast<std::size_t>(segment)];
  SO3 R_W_I = control->pose.asSO3();
  Vector3d p_W = control->pose.translation();
  MotionState state;
  for (const Polynomial& lambda : kBasis) {
    const Weight w = weight_at(lambda, u);
    ++control;
    p_W += w.value * control->translation_step_W;
    state.v_W += w.rate / dt * control->translation_step_W;
    state.a_W += w.acceleration / (dt * dt) * control->translation_step_W;
    const SO3 step = exp_so3(w.value * control->rotation_step);
    R_W_I = R_W_I * step;
    state.omega_I = step.inverse().act(state.omega_I) + w.rate / dt * control->rotation_step;
  }
  state.T_W_I = pose_from(R_W_I, p_W);
  return state;
}

}  // namespace pllit
