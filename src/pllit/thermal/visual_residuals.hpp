// What an image says about the pose: the paper's reprojection residuals of points and of explicit lines
// ("Thermal-Visual Refinement") as normal equations.
#pragma once

#include <span>

#include "pllit/geometry/camera.hpp"
#include "pllit/state/joint_equations.hpp"
#include "pllit/thermal/observations.hpp"

namespace pllit {

struct VisualConfig {
  double point_sigma_px = 1.0;    ///< of a matched point: errors of both detections (the paper's R_0)
  double aligned_sigma_px = 0.5;  ///< of a point that was aligned
  double line_sigma_px = 1.0;     ///< of a line's end point across it (the paper's R_E)
  double loss = 2.5;              ///< residual, in standard deviations, at which a match has half its say
  double gate = 3.5;              ///< residuals beyond this many standard deviations, prior included, do not count
  double max_information = 40.0;  ///< of how many points, if sure of their depth, an image may say as much; 0: no limit
  double common_shift_m = 0.006;  ///< what an image can tell a shift to at best, one sigma; 0: no limit
  bool weights = true;            ///< more weight for points on lines
  double weight_gain = 1.5;       ///< the paper's eta
  double weight_sigma_px = 1.5;   ///< the paper's sigma: distance from the line at which the extra weight fades
  bool lines = true;              ///< explicit lines
  double line_turn_deg = 7.0;     ///< most that an observed line may be turned against the map's
  double line_plane = 0.05;       ///< sine of the least angle between the plane through camera and line, and the image
};

/// The paper's adaptive weights w of points, scaled so that the mean of w^2, which is what the information grows with,
/// is 1: they share out what an image may say and add nothing to it. All 1 where config.weights is off.
std::vector<double> adaptive_weights(std::span<const PointObservation> points, const VisualConfig& config);

/// Of several observed lines that are said to be the same line of the map (parallel edges a few centimetres apart, or
/// one edge in pieces) the one that lies nearest to where a camera at this pose sees it.
std::vector<LineObservation> nearest_of_each(std::span<const LineObservation> lines, const SE3& T_W_I,
                                             std::span<const SE3> T_W_I_keyframes, const SE3& T_I_C,
                                             const Camera& camera);

/// Normal equations over the errors of `state`, of the mount and of the poses at which the keyframes were exposed. Each
/// residual's noise holds the detector's, by weight, and that of its depth or line; a redescending loss (Cauchy's)
/// bounds what false matches say. Matches beyond the gate count with their cost at the gate, so that costs of two
/// states can be compared. `search_covariance`: square, of the prediction, for the gate; empty: no doubt.
JointEquations linearize_image(const NavState& state, const CameraMount& mount, std::span<const SE3> T_W_I_keyframes,
                               const ImageObservations& observations, const Camera& camera, const VisualConfig& config,
                               const Eigen::MatrixXd& search_covariance = {});

/// Covariance of a keyframe's pose (theta, p; right perturbation) as its own points show it, from the detector's noise
/// alone. All later matches share it, so it belongs to the clone of the pose, once, when that is made: then a rig at
/// rest cannot learn the same thing from every image. `points_K`: its points in its camera frame, with depth.
Matrix6 keyframe_noise(std::span<const Vector3d> points_K, const SE3& T_I_C, const Camera& camera, double sigma_px);

}  // namespace pllit
