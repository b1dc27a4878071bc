// A straight line through points that images and LiDAR saw along an edge (the paper's "Spatiotemporal Explicit
// Structural Constraints").
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pllit/state/line_landmark.hpp"

namespace pllit {

/// The points that one image saw along an edge, with the pose as it was estimated then.
struct LineSighting {
  SE3 T_W_C;
  std::vector<EdgePoint> points;
};

struct LineFitConfig {
  int min_points = 20;  ///< the paper's spatial redundancy
  double min_length_m = 0.4;
  double min_linearity = 30.0;   ///< the points' variance along the line over that across it (PCA)
  double max_rms_m = 0.04;       ///< of the points across the line
  double min_inliers = 0.5;      ///< share of the points that must lie on it
  double gate = 3.0;             ///< on it: within as many standard deviations
  double common_sigma_m = 0.01;  ///< error that the points of a sighting share: pose, calibration, blur
};

/// Total least squares through the inliers, each point weighted by its own noise, with the covariance of the four
/// shifts. What the points of one sighting share is not averaged away by their number. The start is the pair of points
/// that most others agree with, in a fixed order of trials. Nothing where a gate fails. Id and sightings are the
/// caller's.
std::optional<LineLandmark> fit_line(std::span<const LineSighting> sightings, const LineFitConfig& config);

/// The same line with its ends, and their covariance, at `from_m` < `to_m` along it from the centroid.
LineLandmark with_ends(const LineLandmark& line, double from_m, double to_m);

}  // namespace pllit
