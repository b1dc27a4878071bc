// A graph of poses and what was measured between them, and its least squares solution. Plain values: the solver's types
// stay inside.
#pragma once

#include <vector>

#include "pllit/state/nav_state.hpp"

/// Seen outside the shared library that GTSAM is kept in.
#define PLLIT_GRAPH_API __attribute__((visibility("default")))

namespace pllit {

/// A measured motion between two poses of a graph.
struct RelativePose {
  int from = 0, to = 0;
  SE3 T_from_to;
  Matrix6 covariance;  ///< of (theta, p), a perturbation on the right: theta and p in the frame of `to`; rad, m
};

/// Where a pose has the vertical: `up_I` points up in its own frame.
struct Upright {
  int pose = 0;
  Vector3d up_I;           ///< unit vector
  double sigma_rad = 0.0;  ///< of its direction
};

/// Poses 0, 1, ... in a frame M whose z axis points up. Pose 0 keeps its place and its heading; it tilts as the
/// verticals say, or within `tilt_sigma_rad` of its guess.
struct PoseGraph {
  std::vector<SE3> guesses_M{};          ///< one for each pose: where the search begins
  std::vector<RelativePose> odometry{};  ///< trusted
  std::vector<RelativePose> loops{};     ///< some may be wrong
  std::vector<Upright> verticals{};
  double tilt_sigma_rad = 0.1;
};

/// Poses in M that minimise the squared, whitened errors of all measurements (Levenberg-Marquardt to convergence, one
/// thread).
PLLIT_GRAPH_API std::vector<SE3> optimised(const PoseGraph& graph);

struct RobustSolution {
  std::vector<SE3> poses_M;
  std::vector<double> loop_weights;  ///< 0: left out as wrong; 1: counts fully
};

/// The same with loops left out that do not agree with the rest: graduated non-convexity with truncated least squares
/// (Yang, Antonante, Tzoumas, Carlone, "Graduated Non-Convexity for Robust Spatial Perception", RA-L 2020). A loop
/// whose squared whitened error exceeds `max_squared_error` at the end is wrong; 16.8 is what one right loop in a
/// hundred exceeds. Where most loops agree far better than their covariances say, the limit is lowered in proportion.
PLLIT_GRAPH_API RobustSolution optimised_robustly(const PoseGraph& graph, double max_squared_error = 16.8);

/// Squared whitened error of a measurement at given poses.
PLLIT_GRAPH_API double squared_error(const RelativePose& measured, const std::vector<SE3>& poses_M);

}  // namespace pllit
