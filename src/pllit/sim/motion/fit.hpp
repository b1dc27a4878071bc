// A smooth motion along a recorded or planned path.
#pragma once

#include "pllit/base/error.hpp"
#include "pllit/sim/motion/motion.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

/// What is faster than cutoff_hz is smoothed away: a sine at f comes through by 1 / (1 + (f / cutoff)^6), so that at
/// half the cut-off 98 % remain.
struct FitConfig {
  double cutoff_hz = 2.0;
  double spacing_s = 0.1;  ///< of the spline's controls
  double max_gap_s = 3.0;  ///< gaps up to this are bridged, longer ones refused
};
/// For a rig in the hands: steps at 2 Hz survive, the jitter of 10 Hz poses does not.
inline constexpr FitConfig kHandHeldFit{.cutoff_hz = 2.5, .spacing_s = 0.1, .max_gap_s = 3.0};
/// For cars: accelerations that tyres can hold.
inline constexpr FitConfig kCarFit{.cutoff_hz = 0.5, .spacing_s = 0.2, .max_gap_s = 5.0};

/// Between the poses of a path and the motion at their times.
struct FitDistance {
  double position_rms_m = 0.0;
  double position_max_m = 0.0;
  double rotation_rms_rad = 0.0;
  double rotation_max_rad = 0.0;
};

struct FittedMotion {
  Motion motion;
  FitDistance distance;
};

/// Smoothing spline through `path`: least squares with a penalty on third differences of the controls (Eilers and Marx,
/// "Flexible smoothing with B-splines and penalties", Statistical Science 1996), rotations by Gauss-Newton. The motion
/// starts at the first pose's time and covers the last. Input errors: fewer than four poses, less than a second, times
/// that do not ascend, a value that is not finite, a gap longer than max_gap_s, a turn of more than 120 deg between two
/// poses.
Expected<FittedMotion> fit_motion(const Trajectory& path, const FitConfig& config);

/// The fitted motion after two seconds of rest, its ramp long enough to reach the path's first speed at no more than
/// 2.5 m/s2. The distance is that of the fit.
Expected<FittedMotion> motion_along(const Trajectory& path, const FitConfig& config);

/// The path up to `factor` times as fast: less so, within three seconds, where its motion would exceed the
/// acceleration, but never slower than it is. Errors as fit_motion.
Expected<Trajectory> sped_up_within(const Trajectory& path, double factor, double max_acceleration_mps2,
                                    const FitConfig& config);

}  // namespace pllit
