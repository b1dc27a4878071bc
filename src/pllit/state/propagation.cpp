#include "pllit/state/propagation.hpp"

#include <algorithm>

namespace pllit {

namespace ix = error_index;

namespace {

struct Input {
  Time time;
  Vector3d gyro_rps, accel_mps2;
};

/// How long the IMU was silent around an instant: between the samples on both sides, or since or until the only one.
Duration silence_around(std::span<const ImuSample> imu, Time time) {
  const auto after = std::ranges::upper_bound(imu, time, {}, &ImuSample::time);
  if (after == imu.end()) return time - imu.back().time;
  if (after == imu.begin()) return after->time - time;
  return after->time - (after - 1)->time;
}

Input interpolate(const ImuSample& a, const ImuSample& b, Time time) {
  const double s = to_seconds(time - a.time) / to_seconds(b.time - a.time);
  return {time, (1.0 - s) * a.gyro_rps + s * b.gyro_rps, (1.0 - s) * a.accel_mps2 + s * b.accel_mps2};
}

/// IMU reading at `time`: interpolated between its neighbours, held at the ends.
Input reading_at(std::span<const ImuSample> imu, Time time) {
  const auto after = std::ranges::lower_bound(imu, time, {}, &ImuSample::time);
  if (after == imu.end()) return {time, imu.back().gyro_rps, imu.back().accel_mps2};
  if (after == imu.begin() || after->time == time) return {time, after->gyro_rps, after->accel_mps2};
  return interpolate(*(after - 1), *after, time);
}

/// Readings at `begin`, at every sample between, and at `end`.
std::vector<Input> readings_between(std::span<const ImuSample> imu, Time begin, Time end) {
  std::vector<Input> inputs{reading_at(imu, begin)};
  for (const ImuSample& sample : imu)
    if (sample.time > begin && sample.time < end) inputs.push_back({sample.time, sample.gyro_rps, sample.accel_mps2});
  inputs.push_back(reading_at(imu, end));
  return inputs;
}

/// Covariance of the noise (n_g, n_a, n_bg, n_ba) held over one step of dt: a continuous density s averages to s^2/dt;
/// a walk of density w grows by w^2 dt, which the Jacobian's factor dt turns into w^2/dt here.
Eigen::Matrix<double, 12, 1> step_noise(const ImuNoise& noise, double dt_s) {
  const auto variance = [dt_s](double density) { return Vector3d::Constant(density * density / dt_s); };
  Eigen::Matrix<double, 12, 1> q;
  q << variance(noise.gyro_density), variance(noise.accel_density), variance(noise.gyro_bias_walk),
      variance(noise.accel_bias_walk);
  return q;
}

void symmetrise(Matrix18& covariance) { covariance = 0.5 * (covariance + covariance.transpose()).eval(); }

PathNode node_of(const NavState& state, const Vector3d& omega_I, const Vector3d& accel_W) {
  return {state.time, state.R_W_I, state.p_W, state.v_W, omega_I, accel_W};
}

/// Crosses a stretch without IMU samples: straight on, with the uncertainty of the gap model.
void cross_gap(Estimate& estimate, Duration dt, const GapModel& gaps) {
  const Vector3d hover = estimate.mean.R_W_I.inverse().act(-estimate.mean.gravity_W) + estimate.mean.accel_bias;
  const ImuStep step = imu_step(estimate.mean, estimate.mean.gyro_bias, hover, dt);
  Eigen::Matrix<double, 12, 1> q = Eigen::Matrix<double, 12, 1>::Zero();
  q.head<3>().setConstant(gaps.rate_sigma_rps * gaps.rate_sigma_rps);
  q.segment<3>(3).setConstant(gaps.accel_sigma_mps2 * gaps.accel_sigma_mps2);
  estimate.covariance = step.J_next_error * estimate.covariance * step.J_next_error.transpose() +
                        step.J_next_noise * q.asDiagonal() * step.J_next_noise.transpose();
  estimate.mean = step.state;
}

}  // namespace

ImuStep imu_step(const NavState& state, const Vector3d& gyro_rps, const Vector3d& accel_mps2, Duration dt) {
  const double t = to_seconds(dt);
  const Vector3d phi = (gyro_rps - state.gyro_bias) * t;
  const Vector3d force_I = accel_mps2 - state.accel_bias;
  const Matrix3d R = state.R_W_I.rotation();
  const Vector3d accel_W = R * force_I + state.gravity_W;

  ImuStep step;
  step.state = state;
  step.state.time = state.time + dt;
  step.state.R_W_I = state.R_W_I * exp_so3(phi);
  step.state.p_W += (state.v_W + 0.5 * accel_W * t) * t;
  step.state.v_W += accel_W * t;

  const Matrix3d I = Matrix3d::Identity(), R_force = R * skew(force_I), Jr = right_jacobian(phi);
  Matrix18& F = step.J_next_error;
  F.setIdentity();
  F.block<3, 3>(ix::theta, ix::theta) = exp_so3(-phi).rotation();
  F.block<3, 3>(ix::theta, ix::bg) = -Jr * t;
  F.block<3, 3>(ix::p, ix::theta) = -0.5 * R_force * t * t;
  F.block<3, 3>(ix::p, ix::v) = I * t;
  F.block<3, 3>(ix::p, ix::ba) = -0.5 * R * t * t;
  F.block<3, 3>(ix::p, ix::g) = 0.5 * I * t * t;
  F.block<3, 3>(ix::v, ix::theta) = -R_force * t;
  F.block<3, 3>(ix::v, ix::ba) = -R * t;
  F.block<3, 3>(ix::v, ix::g) = I * t;

  Matrix18x12& G = step.J_next_noise;
  G.setZero();
  G.block<3, 3>(ix::theta, 0) = -Jr * t;
  G.block<3, 3>(ix::p, 3) = -0.5 * R * t * t;
  G.block<3, 3>(ix::v, 3) = -R * t;
  G.block<3, 3>(ix::bg, 6) = I * t;
  G.block<3, 3>(ix::ba, 9) = I * t;
  return step;
}

SE3 extrapolate(const PathNode& node, double dt_s) {
  return pose_from(node.R_W_I * exp_so3(node.omega_I * dt_s),
                   node.p_W + (node.v_W + 0.5 * node.accel_W * dt_s) * dt_s);
}

SE3 MotionPath::pose_at(Time time) const {
  auto after = std::ranges::upper_bound(nodes, time, {}, &PathNode::time);
  if (after != nodes.begin()) --after;
  return extrapolate(*after, to_seconds(time - after->time));
}

Propagation propagate(const Estimate& from, std::span<const ImuSample> imu, Time until, const ImuNoise& noise,
                      const GapModel& gaps) {
  Propagation result{.path = {}, .predicted = from, .longest_gap = Duration{0}};
  Estimate& now = result.predicted;
  if (imu.empty()) {
    result.path.nodes.push_back(node_of(now.mean, Vector3d::Zero(), Vector3d::Zero()));
    result.longest_gap = until - from.mean.time;
    if (until > from.mean.time) cross_gap(now, until - from.mean.time, gaps);
  } else {
    const auto inputs = readings_between(imu, from.mean.time, until);
    for (std::size_t i = 0; i + 1 < inputs.size(); ++i) {
      const Duration dt = inputs[i + 1].time - inputs[i].time;
      if (dt <= Duration{0}) continue;
      // Asked just inside the step's end: a last sample that is held for long becomes a gap, however short the packets.
      const Duration silence = silence_around(imu, inputs[i + 1].time - Duration{1});
      result.longest_gap = std::max(result.longest_gap, silence);
      if (silence > gaps.max_gap) {
        result.path.nodes.push_back(node_of(now.mean, Vector3d::Zero(), Vector3d::Zero()));
        cross_gap(now, dt, gaps);
        continue;
      }
      const Vector3d gyro = 0.5 * (inputs[i].gyro_rps + inputs[i + 1].gyro_rps);
      const Vector3d accel = 0.5 * (inputs[i].accel_mps2 + inputs[i + 1].accel_mps2);
      const Vector3d accel_W = now.mean.R_W_I.act(accel - now.mean.accel_bias) + now.mean.gravity_W;
      result.path.nodes.push_back(node_of(now.mean, gyro - now.mean.gyro_bias, accel_W));
      const ImuStep step = imu_step(now.mean, gyro, accel, dt);
      const auto q = step_noise(noise, to_seconds(dt));
      now.covariance = step.J_next_error * now.covariance * step.J_next_error.transpose() +
                       step.J_next_noise * q.asDiagonal() * step.J_next_noise.transpose();
      now.mean = step.state;
    }
  }
  symmetrise(now.covariance);
  // A last node at the end, so that the path reaches it; it goes on as the one before.
  PathNode last = node_of(now.mean, Vector3d::Zero(), Vector3d::Zero());
  if (!result.path.nodes.empty()) {
    last.omega_I = result.path.nodes.back().omega_I;
    last.accel_W = result.path.nodes.back().accel_W;
  }
  result.path.nodes.push_back(last);
  return result;
}

}  // namespace pllit
