// Photometric anchoring: each image's greys are tied to what the map holds of the surfaces that it shows, so that
// neither the drift of a gain control nor that of the camera is taken for heat.
#pragma once

#include <span>
#include <vector>

#include "pllit/map/thermal_map.hpp"

namespace pllit {

/// An image's intensity of a surface, and the map's.
struct AnchorPair {
  float now = 0.0F, normal = 0.0F;
  float weight = 1.0F;  ///< more for what is well known
};

/// Intensities as they come to those of the map: a straight line, and where a gain control is not one, a polyline added
/// to it. Increasing.
struct AnchorCurve {
  double gain = 1.0, bias = 0.0;
  std::vector<double> knots{}, offsets{};  ///< ascending; none for a straight line; constant beyond the ends

  double operator()(double intensity) const;
};

struct AnchorConfig {
  enum class Shape {
    bias,    ///< radiometric cameras drift as a whole
    affine,  ///< linear gain control
    curve    ///< histogram equalisation
  };
  Shape shape = Shape::curve;
  double loss = 12.0;      ///< width of Tukey's biweight, in the map's unit; narrowed to from four times as much
  int min_pairs = 150;     ///< inliers, in voxels
  double min_share = 0.5;  ///< of the pairs that must be inliers
  int knots = 17;
};

struct AnchorFit {
  AnchorCurve curve{};
  int pairs = 0, inliers = 0;
  double rms = 0.0;    ///< of the inliers' residuals, in the map's unit
  bool holds = false;  ///< enough inliers; otherwise the curve is the one before
};

/// Pairs of an image's observations with voxels that have been seen a few times and that nothing has changed in.
std::vector<AnchorPair> anchor_pairs(const ThermalMap& map, const std::vector<SurfaceObservation>& observations);

/// Robust fit by reweighted least squares with a loss that narrows (graduated non-convexity: Blake and Zisserman 1987),
/// from the curve before and from the line that takes the quartiles to each other, whichever explains more. What is hot
/// cannot drag it: its pairs lie off the line that the others agree on, and because the curve increases, greys above
/// those of all unchanged surfaces stay above.
AnchorFit anchor_curve(std::span<const AnchorPair> pairs, const AnchorCurve& before, const AnchorConfig& config);

}  // namespace pllit
