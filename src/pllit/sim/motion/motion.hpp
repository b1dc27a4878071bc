// A smooth rigid motion whose velocity, acceleration and angular rate are exact: the truth that sensors are simulated
// from.
#pragma once

#include <optional>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/geometry/lie.hpp"
#include "pllit/sim/motion/vibration.hpp"

namespace pllit {

/// The rig at one instant. W: world, z up; I: IMU.
struct MotionState {
  SE3 T_W_I = SE3::Identity();
  Vector3d v_W = Vector3d::Zero();      ///< m/s
  Vector3d a_W = Vector3d::Zero();      ///< m/s2, without gravity
  Vector3d omega_I = Vector3d::Zero();  ///< rad/s, of I against W
};

/// How a motion begins: at rest at its first pose, then with its own clock running up to full pace. The pace has two
/// continuous derivatives, so that acceleration and angular acceleration are continuous.
struct SoftStart {
  double rest_s = 2.0;
  double ramp_s = 1.5;
};

/// Uniform cumulative quintic B-spline over poses, four times continuously differentiable; derivatives after Sommer et
/// al., "Efficient derivative computation for cumulative B-splines on Lie groups", CVPR 2020, equations 12, 26 and 27.
/// Positions stay in the convex hull of six neighbouring controls; equal controls give exact rest. A soft start and a
/// vibration may lie over it.
class Motion {
 public:
  /// Control i pulls at the path most strongly at start + (i - 2) * spacing; at least six are needed, and the motion
  /// lasts (controls - 5) * spacing. Neighbouring rotations differ by less than half a turn.
  Motion(Time start, Duration spacing, const std::vector<SE3>& controls);

  /// The same motion begun softly, later at its end by rest_s + ramp_s / 2; of a motion without either addition.
  Motion after_rest(const SoftStart& soft_start) const;
  /// The same motion, shaken in measure of its speed; of a motion without vibration. Rest stays exact.
  Motion with_vibration(const VibrationConfig& config) const;

  /// The same motion of another frame of the rig, at the same place but turned: R_I_J, of a motion without vibration.
  Motion of_turned_frame(const SO3& R_I_J) const;

  Time start() const { return start_; }
  Time end() const;

  /// State at `time`, which is clamped to [start, end].
  MotionState at(Time time) const;

 private:
  /// A control with the step that leads to it.
  struct Control {
    SE3 pose;
    Vector3d translation_step_W;
    Vector3d rotation_step;  ///< Log(R_before^T R)
  };
  std::size_t segments() const { return controls_.size() - 5; }
  MotionState on_spline(double t_s) const;

  Time start_;
  Duration spacing_;
  std::vector<Control> controls_;
  std::optional<SO3> R_I_J_;
  std::optional<SoftStart> soft_start_;
  std::optional<Vibration> vibration_;
};

}  // namespace pllit
