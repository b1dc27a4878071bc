#include "pllit/sim/motion/motion.hpp"

#include <algorithm>
#include <cassert>

#include "pllit/sim/motion/quintic_basis.hpp"

namespace pllit {
namespace {

/// Time on the spline against time since the start.
struct Clock {
  double t_s, rate, rate_change_ps;
};

/// The pace is 10 x^3 - 15 x^4 + 6 x^5 over the ramp.
Clock clock_at(const SoftStart& soft, double t_s) {
  const double x = (t_s - soft.rest_s) / soft.ramp_s;
  if (x <= 0.0) return {0.0, 0.0, 0.0};
  if (x >= 1.0) return {t_s - soft.rest_s - 0.5 * soft.ramp_s, 1.0, 0.0};
  const double x3 = x * x * x;
  return {soft.ramp_s * x3 * x * (2.5 + x * (x - 3.0)), x3 * (10.0 + x * (6.0 * x - 15.0)),
          30.0 * x * x * (1.0 - x) * (1.0 - x) / soft.ramp_s};
}

void run_at(const Clock& clock, MotionState& state) {
  state.a_W = clock.rate * clock.rate * state.a_W + clock.rate_change_ps * state.v_W;
  state.v_W *= clock.rate;
  state.omega_I *= clock.rate;
}

void shake(const VibrationState& vibration, MotionState& state) {
  const SO3 shaken_R = exp_so3(vibration.angle_I);
  state.T_W_I = pose_from(state.T_W_I.asSO3() * shaken_R, state.T_W_I.translation() + vibration.offset_W);
  state.v_W += vibration.offset_rate_W;
  state.a_W += vibration.offset_acceleration_W;
  state.omega_I = shaken_R.inverse().act(state.omega_I) + right_jacobian(vibration.angle_I) * vibration.angle_rate_I;
}

}  // namespace

Motion::Motion(Time start, Duration spacing, const std::vector<SE3>& controls) : start_(start), spacing_(spacing) {
  assert(controls.size() >= quintic::kOrder && spacing > Duration::zero());
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

Motion Motion::after_rest(const SoftStart& soft_start) const {
  assert(!soft_start_ && !vibration_ && soft_start.rest_s >= 0.0 && soft_start.ramp_s > 0.0);
  Motion softly = *this;
  softly.soft_start_ = soft_start;
  return softly;
}

Motion Motion::with_vibration(const VibrationConfig& config) const {
  assert(!vibration_);
  constexpr double kSpacing_s = 0.2;
  std::vector<double> speeds_mps;
  const double duration_s = to_seconds(end() - start_);
  for (double t_s = 0.0; t_s <= duration_s + kSpacing_s; t_s += kSpacing_s)
    speeds_mps.push_back(at(start_ + from_seconds(t_s)).v_W.norm());
  Motion shaken = *this;
  shaken.vibration_ = Vibration(config, kSpacing_s, speeds_mps);
  return shaken;
}

Motion Motion::of_turned_frame(const SO3& R_I_J) const {
  assert(!R_I_J_ && !vibration_);
  Motion turned = *this;
  turned.R_I_J_ = R_I_J;
  return turned;
}

Time Motion::end() const {
  const Time end = start_ + static_cast<std::int64_t>(segments()) * spacing_;
  return soft_start_ ? end + from_seconds(soft_start_->rest_s + 0.5 * soft_start_->ramp_s) : end;
}

MotionState Motion::at(Time time) const {
  const double t_s = to_seconds(std::clamp(time, start_, end()) - start_);
  MotionState state;
  if (soft_start_) {
    const Clock clock = clock_at(*soft_start_, t_s);
    state = on_spline(clock.t_s);
    run_at(clock, state);
  } else {
    state = on_spline(t_s);
  }
  if (R_I_J_) {
    state.T_W_I = pose_from(state.T_W_I.asSO3() * *R_I_J_, state.T_W_I.translation());
    state.omega_I = R_I_J_->inverse().act(state.omega_I);
  }
  if (vibration_) shake(vibration_->at(t_s), state);
  return state;
}

MotionState Motion::on_spline(double t_s) const {
  const double dt = to_seconds(spacing_);
  const auto [segment, u] = quintic::place_of(t_s / dt, segments());

  const Control* control = &controls_[segment];
  SO3 R_W_I = control->pose.asSO3();
  Vector3d p_W = control->pose.translation();
  MotionState state;
  for (const quintic::Polynomial& lambda : quintic::kCumulativeBasis) {
    const quintic::Weight w = quintic::weight_at(lambda, u);
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
