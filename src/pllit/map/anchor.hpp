// Photometric anchoring: each image's greys are tied to what the map holds of the surfaces that it shows, so that
// neither the drift of a gain control nor that of the camera is taken for heat.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "pllit/map/thermal_map.hpp"

namespace pllit {

/// An image's intensity of a surface, and the map's.
struct AnchorPair {
  float now = 0.0F, normal = 0.0F;
  float radius2 = 0.0F;          ///< squared distance from the middle of the image, 1 in its corners
  float normal_variance = 0.0F;  ///< of the error of `normal`
  float weight = 1.0F;           ///< more for what is well known
  float trust = 1.0F;            ///< less for what was itself learned in doubt: it may tie images to each other only
};

/// Intensities as they come to those of the map: a straight line, and where a gain control is not one, a polyline added
/// to it. Increasing.
struct AnchorCurve {
  double gain = 1.0, bias = 0.0;
  double lens = 0.0;  ///< what the image has too much at the squared radius 1, before the rest: vignetting
  std::vector<double> knots{}, offsets{};  ///< ascending; none for a straight line; constant beyond the ends
  /// Intensities, without the lens, between which known surfaces hold it.
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  double slope_doubt = 0.0;  ///< beyond them, one sigma, as a share of the slope

  double operator()(double intensity, double radius2 = 0.0) const;
  /// One sigma of what it gives, beyond the spread of single surfaces: nothing between `low` and `high`.
  double doubt(double intensity, double radius2 = 0.0) const;
};

struct AnchorConfig {
  enum class Shape {
    bias,    ///< radiometric cameras drift as a whole
    affine,  ///< linear gain control
    curve    ///< histogram equalisation
  };
  Shape shape = Shape::curve;
  double loss =
      12.0;  ///< pairs that differ by more do not count, in the map's unit; narrowed to from four times as much
  double slope_sigma = 0.0;  ///< how far from 1 the slope of a line may be; 0: anywhere, near that of the image before
  int min_pairs = 150;       ///< inliers, in voxels
  double min_share = 0.5;    ///< of the pairs that must be inliers
  int knots = 17;
  /// How far the slope of a curve beyond what known surfaces show may be off, one sigma, as a share. A gain control
  /// that equalises bends where it likes; a linear one is only as good as its slope.
  double curve_slope_doubt = 0.3, affine_slope_doubt = 0.1;
};

struct AnchorFit {
  AnchorCurve curve{};
  int pairs = 0, inliers = 0;
  double rms = 0.0;     ///< of the inliers' residuals, in the map's unit
  double spread = 0.0;  ///< standard deviation of all residuals, robust: how well this image shows what is known
  bool holds = false;   ///< enough inliers; otherwise the curve is the one before
};

/// Pairs of an image's observations with voxels that have been seen a few times; the longer one has looked unusual, the
/// less it weighs.
std::vector<AnchorPair> anchor_pairs(const ThermalMap& map, const std::vector<SurfaceObservation>& observations,
                                     const Camera& camera);
/// Squared distance of a pixel from the middle of the image, 1 in its corners.
double squared_radius(const Eigen::Vector2f& pixel_px, const Camera& camera);

/// Robust fit by reweighted least squares with a loss that narrows (graduated non-convexity: Blake and Zisserman 1987),
/// from the curve before and from the one through the medians of surfaces alike, whichever explains more. What is seen
/// is regressed on what is known, whose noise is less and is taken into account: the other way round the noise of every
/// image would flatten the curve, and surfaces learned through it those of the next ones, until nothing differed any
/// more. Where the surfaces in sight hardly differ, the gain stays near the one before. What is hot cannot drag the
/// curve: its pairs lie off the one that the others agree on, and because it increases, intensities above those of all
/// unchanged surfaces stay above.
AnchorFit anchor_curve(std::span<const AnchorPair> pairs, const AnchorCurve& before, const AnchorConfig& config);

}  // namespace pllit
