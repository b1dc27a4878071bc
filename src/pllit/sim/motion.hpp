// A smooth rigid motion whose velocity, acceleration and angular rate are exact: the truth that sensors are simulated
// from.
#pragma once

#include <cstdint>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/geometry/lie.hpp"

namespace pllit {

/// The rig at one instant. W: world, z up; I: IMU.
struct MotionState {
  SE3 T_W_I = SE3::Identity();
  Vector3d v_W = Vector3d::Zero();      ///< m/s
  Vector3d a_W = Vector3d::Zero();      ///< m/s2, without gravity
  Vector3d omega_I = Vector3d::Zero();  ///< rad/s, of I against W
};

/// Uniform cumulative quintic B-spline over poses, four times continuously differentiable; derivatives after Sommer et
/// al., "Efficient derivative computation for cumulative B-splines on Lie groups", CVPR 2020, equations 12, 26 and 27.
/// Positions stay in the convex hull of six neighbouring controls; equal controls give exact rest.
class Motion {
 public:
  /// Control i pulls at the path most strongly at start + (i - 2) * spacing; at least six are needed, and the motion
  /// lasts (controls - 5) * spacing. Neighbouring rotations differ by less than half a turn.
  Motion(Time start, Duration spacing, const std::vector<SE3>& controls);

  Time start() const { return start_; }
  Time end() const { return start_ + segments() * spacing_; }

  /// State at `time`, which is clamped to [start, end].
  MotionState at(Time time) const;

 private:
  /// A control with the step that leads to it.
  struct Control {
    SE3 pose;
    Vector3d translation_step_W;
    Vector3d rotation_step;  ///< Log(R_before^T R)
  };
  std::int64_t segments() const { return static_cast<std::int64_t>(controls_.size()) - 5; }

  Time start_;
  Duration spacing_;
  std::vector<Control> controls_;
};

}  // namespace pllit
