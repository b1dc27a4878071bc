// Forward propagation with the IMU: the paper's eqs. (2)-(6).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sensor/rig.hpp"
#include "pllit/state/iterated_update.hpp"

namespace pllit {

using Matrix18x12 = Eigen::Matrix<double, error_index::size, 12>;

/// One step of constant rate and specific force: new state and its Jacobians to the old error and to the noise
/// (n_g, n_a, n_bg, n_ba), derived from eq. (3), checked against central differences in the tests.
struct ImuStep {
  NavState state;
  Matrix18 J_next_error;
  Matrix18x12 J_next_noise;
};
ImuStep imu_step(const NavState& state, const Vector3d& gyro_rps, const Vector3d& accel_mps2, Duration dt);

/// Pose, velocity and the motion that holds from this node to the next one.
struct PathNode {
  Time time;
  SO3 R_W_I;
  Vector3d p_W, v_W;
  Vector3d omega_I;  ///< rad/s, bias removed
  Vector3d accel_W;  ///< m/s2, gravity removed
};

/// The motion during one packet: nodes with ascending times, the last at the packet's end. Never empty.
struct MotionPath {
  std::vector<PathNode> nodes;

  /// Pose at a time: the motion of the latest node not after it; before the first node that node's motion, backwards.
  SE3 pose_at(Time time) const;
};
/// Where a node's motion leads after dt (which may be negative).
SE3 extrapolate(const PathNode& node, double dt_s);

/// What a scan measures. Its points are taken all along a sweep and brought to its end by the
/// predicted motion, with that motion's errors: matched together they tell the mean pose error
/// of the sweep (seen from its end), not the one at its end. Noise of the IMU during the sweep
/// is in both, which a filter that takes one for the other counts as new information.
struct SweepPrediction {
  Estimate estimate;                     ///< the predicted end, its pose error replaced by the mean over the sweep
  Matrix18 with_end = Matrix18::Zero();  ///< covariance of the error at the end (rows) with the estimate's (columns)
  Matrix18 J_estimate_begin = Matrix18::Identity();  ///< of the estimate's error to the one that the packet began with
};

struct Propagation {
  MotionPath path;
  Estimate predicted;     ///< at `until`
  Matrix18 J_end_begin;   ///< of the error there to the one at the beginning
  SweepPrediction sweep;  ///< of the sweep that ends there
  Duration longest_gap;   ///< longest stretch without an IMU sample
};

/// What to assume of the motion where IMU samples are missing for longer than `max_gap`: that the rig goes on as it
/// was, to within these random accelerations and rates.
struct GapModel {
  Duration max_gap = std::chrono::milliseconds(250);
  double accel_sigma_mps2 = 3.0;
  double rate_sigma_rps = 0.5;
};

/// Propagates `from` to `until`. `imu` ascends in time, in SI units; the last sample at or before
/// from.time and the first one at or after `until` should be among them (values between samples
/// are interpolated linearly, and held where a side is missing). Noise densities are discretised
/// by the length of each step, so any sample rate serves. A sweep goes evenly from `sweep_begin`
/// (or from.time, where that is later) to `until`; without one it is the instant `until`.
Propagation propagate(const Estimate& from, std::span<const ImuSample> imu, Time until, const ImuNoise& noise,
                      const GapModel& gaps = {}, std::optional<Time> sweep_begin = std::nullopt);

/// The estimate at the end of a sweep, given what has been learnt of the sweep: as a smoother carries news from one
/// state to another that is correlated with it (Rauch, Tung and Striebel 1965).
struct SmoothedEnd {
  Estimate estimate;
  Matrix18 J_end_begin;  ///< of its error to the one that the packet began with
};
SmoothedEnd at_end(const Propagation& motion, const UpdateResult& sweep_update);

}  // namespace pllit
