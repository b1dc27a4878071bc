#include "pllit/state/propagation.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

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

/// IMU reading at `time`: interpolated between its neighbours, held at the ends; zero without any.
Input reading_at(std::span<const ImuSample> imu, Time time) {
  if (imu.empty()) return {time, Vector3d::Zero(), Vector3d::Zero()};
  const auto after = std::ranges::lower_bound(imu, time, {}, &ImuSample::time);
  if (after == imu.end()) return {time, imu.back().gyro_rps, imu.back().accel_mps2};
  if (after == imu.begin() || after->time == time) return {time, after->gyro_rps, after->accel_mps2};
  return interpolate(*(after - 1), *after, time);
}

/// Readings at `begin`, at every sample between, at `also`, and at `end`.
std::vector<Input> readings_between(std::span<const ImuSample> imu, Time begin, Time also, Time end) {
  std::vector<Input> inputs{reading_at(imu, begin)};
  const auto add_until = [&](Time until) {
    for (const ImuSample& sample : imu)
      if (sample.time > inputs.back().time && sample.time < until)
        inputs.push_back({sample.time, sample.gyro_rps, sample.accel_mps2});
    inputs.push_back(reading_at(imu, until));
  };
  add_until(also);
  add_until(end);
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

Vector3d accel_in_W(const NavState& state, const Vector3d& accel_mps2) {
  return state.R_W_I.act(accel_mps2 - state.accel_bias) + state.gravity_W;
}

/// The step across a stretch without IMU samples: straight on.
ImuStep gap_step(const NavState& state, Duration dt) {
  const Vector3d hover = state.R_W_I.inverse().act(-state.gravity_W) + state.accel_bias;
  return imu_step(state, state.gyro_bias, hover, dt);
}

/// Its noise: the uncertainty of the gap model.
Eigen::Matrix<double, 12, 1> gap_noise(const GapModel& gaps) {
  Eigen::Matrix<double, 12, 1> q = Eigen::Matrix<double, 12, 1>::Zero();
  q.head<3>().setConstant(gaps.rate_sigma_rps * gaps.rate_sigma_rps);
  q.segment<3>(3).setConstant(gaps.accel_sigma_mps2 * gaps.accel_sigma_mps2);
  return q;
}

void advance(Estimate& now, const ImuStep& step, const Eigen::Matrix<double, 12, 1>& noise) {
  now.covariance = step.J_next_error * now.covariance * step.J_next_error.transpose() +
                   step.J_next_noise * noise.asDiagonal() * step.J_next_noise.transpose();
  now.mean = step.state;
}

/// The sum s of weighted pose errors along a sweep, as twists of W about a fixed point, with its covariances.
class SweepSum {
 public:
  SweepSum(Time begin, Time end, const Vector3d& about_W)
      : begin_(begin), duration_s_(to_seconds(end - begin)), about_W_(about_W) {}

  /// Half of the share of the time `dt` next to `now`, its error being the latest.
  void add(const Estimate& now, Time from, Duration dt) {
    if (from < begin_) return;
    const double weight = 0.5 * to_seconds(dt) / duration_s_;
    Eigen::Matrix<double, 6, ix::size> J_twist_error = Eigen::Matrix<double, 6, ix::size>::Zero();
    const Matrix3d R = now.mean.R_W_I.rotation();
    J_twist_error.block<3, 3>(0, ix::theta) = R;
    J_twist_error.block<3, 3>(3, ix::theta) = skew(now.mean.p_W - about_W_) * R;
    J_twist_error.block<3, 3>(3, ix::p).setIdentity();
    const Matrix18x6 with_twist = now.covariance * J_twist_error.transpose();
    J_twist_begin_ += weight * J_twist_error * J_error_begin_;
    const Matrix6 cross = J_twist_error * with_error_;
    covariance_ += weight * (cross + cross.transpose()) + weight * weight * J_twist_error * with_twist;
    with_error_ += weight * with_twist;
  }
  void step(const Matrix18& J_next_error) {
    with_error_ = (J_next_error * with_error_).eval();
    J_error_begin_ = (J_next_error * J_error_begin_).eval();
  }
  /// Of the latest error to the one at the beginning.
  const Matrix18& J_error_begin() const { return J_error_begin_; }

  /// As a pose error at the end, jointly with the other states there.
  SweepPrediction seen_from(const Estimate& end) const {
    Matrix6 J_pose_twist = Matrix6::Zero();
    J_pose_twist.topLeftCorner<3, 3>() = end.mean.R_W_I.rotation().transpose();
    J_pose_twist.bottomLeftCorner<3, 3>() = -skew(end.mean.p_W - about_W_);
    J_pose_twist.bottomRightCorner<3, 3>().setIdentity();
    SweepPrediction sweep{.estimate = end, .with_end = end.covariance, .J_estimate_begin = J_error_begin_};
    sweep.J_estimate_begin.topRows<ix::pose_size>() = J_pose_twist * J_twist_begin_;
    sweep.with_end.leftCols<ix::pose_size>() = with_error_ * J_pose_twist.transpose();
    Matrix18& P = sweep.estimate.covariance;
    P.topLeftCorner<6, 6>() = J_pose_twist * covariance_ * J_pose_twist.transpose();
    P.bottomLeftCorner<12, 6>() = sweep.with_end.bottomLeftCorner<12, 6>();
    P.topRightCorner<6, 12>() = P.bottomLeftCorner<12, 6>().transpose();
    symmetrise(P);
    return sweep;
  }

 private:
  using Matrix18x6 = Eigen::Matrix<double, ix::size, 6>;
  Time begin_;
  double duration_s_;
  Vector3d about_W_;
  Matrix18x6 with_error_ = Matrix18x6::Zero();  // covariance of the latest error with s
  Matrix6 covariance_ = Matrix6::Zero();        // of s
  Matrix18 J_error_begin_ = Matrix18::Identity();
  Eigen::Matrix<double, 6, ix::size> J_twist_begin_ = Eigen::Matrix<double, 6, ix::size>::Zero();
};

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
  return pose_from(node.R_W_I * exp_so3(node.omega_I * dt_s), node.p_W + (node.v_W + 0.5 * node.accel_W * dt_s) * dt_s);
}

SE3 MotionPath::pose_at(Time time) const {
  auto after = std::ranges::upper_bound(nodes, time, {}, &PathNode::time);
  if (after != nodes.begin()) --after;
  return extrapolate(*after, to_seconds(time - after->time));
}

Propagation propagate(const Estimate& from, std::span<const ImuSample> imu, Time until, const ImuNoise& noise,
                      const GapModel& gaps, std::optional<Time> sweep_begin) {
  Propagation result{.path = {}, .predicted = from, .J_end_begin = {}, .sweep = {}, .longest_gap = Duration{0}};
  Estimate& now = result.predicted;
  const Time begin = std::clamp(sweep_begin.value_or(until), from.mean.time, std::max(until, from.mean.time));
  SweepSum sweep(begin, until, from.mean.p_W);
  const auto inputs = readings_between(imu, from.mean.time, begin, until);
  for (std::size_t i = 0; i + 1 < inputs.size(); ++i) {
    const Time time = inputs[i].time;
    const Duration dt = inputs[i + 1].time - time;
    if (dt <= Duration{0}) continue;
    // Asked just inside the step's end: a last sample that is held for long becomes a gap, however short the packets.
    const Duration silence = imu.empty() ? dt : silence_around(imu, inputs[i + 1].time - Duration{1});
    result.longest_gap = std::max(result.longest_gap, silence);
    const bool gap = imu.empty() || silence > gaps.max_gap;
    const Vector3d gyro = 0.5 * (inputs[i].gyro_rps + inputs[i + 1].gyro_rps);
    const Vector3d accel = 0.5 * (inputs[i].accel_mps2 + inputs[i + 1].accel_mps2);
    const ImuStep step = gap ? gap_step(now.mean, dt) : imu_step(now.mean, gyro, accel, dt);
    result.path.nodes.push_back(node_of(now.mean, gap ? Vector3d::Zero() : Vector3d(gyro - now.mean.gyro_bias),
                                        gap ? Vector3d::Zero() : accel_in_W(now.mean, accel)));
    sweep.add(now, time, dt);
    advance(now, step, gap ? gap_noise(gaps) : step_noise(noise, to_seconds(dt)));
    sweep.step(step.J_next_error);
    sweep.add(now, time, dt);
  }
  symmetrise(now.covariance);
  result.J_end_begin = sweep.J_error_begin();
  result.sweep = begin < until ? sweep.seen_from(now) : SweepPrediction{now, now.covariance, sweep.J_error_begin()};
  // A last node at the end, so that the path reaches it; it goes on as the one before.
  PathNode last = node_of(now.mean, Vector3d::Zero(), Vector3d::Zero());
  if (!result.path.nodes.empty()) {
    last.omega_I = result.path.nodes.back().omega_I;
    last.accel_W = result.path.nodes.back().accel_W;
  }
  result.path.nodes.push_back(last);
  return result;
}

SmoothedEnd at_end(const Propagation& motion, const UpdateResult& sweep_update) {
  const SweepPrediction& sweep = motion.sweep;
  const Estimate &end = motion.predicted, &posterior = sweep_update.posterior;
  // Scaled to a unit diagonal, so that one threshold tells what is known exactly in every unit.
  const Matrix18& P = sweep.estimate.covariance;
  const Vector18 scale = P.diagonal().unaryExpr([](double v) { return v > 0.0 ? 1.0 / std::sqrt(v) : 0.0; });
  Eigen::CompleteOrthogonalDecomposition<Matrix18> whitened;
  whitened.setThreshold(1e-10);
  whitened.compute(scale.asDiagonal() * P * scale.asDiagonal());
  const Matrix18 gain = sweep.with_end * scale.asDiagonal() * whitened.pseudoInverse() * scale.asDiagonal();
  Estimate updated{.mean = boxplus(end.mean, gain * boxminus(posterior.mean, sweep.estimate.mean)),
                   .covariance = end.covariance + gain * (posterior.covariance - P) * gain.transpose()};
  symmetrise(updated.covariance);
  const Matrix18 news = sweep_update.J_posterior_prior - Matrix18::Identity();
  return {updated, motion.J_end_begin + gain * news * sweep.J_estimate_begin};
}

}  // namespace pllit
