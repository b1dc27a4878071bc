// Online photometric calibration: what a thermal camera's gain control did to the greys, from the greys of tracked
// features.
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

namespace pllit {

/// One tracked feature: its grey in the reference keyframe, calibrated, and in the current frame, raw; 0 to 255.
struct GreyPair {
  float reference = 0.0F, current = 0.0F;
};

/// Raw to calibrated greys: the paper's effective gain (a - b) and bias b, and where that does not do, a polyline added
/// to it. Increasing.
struct GreyCurve {
  double gain = 1.0;
  double bias = 0.0;            ///< grey levels
  std::vector<double> knots;    ///< raw greys, ascending, at least two; none for an affine curve
  std::vector<double> offsets;  ///< added at the knots, linear between them, constant beyond

  double operator()(double raw) const;
};

/// The calibrated image, CV_32FC1 in grey levels, of a raw CV_8UC1 one. Greys may leave 0 to 255.
cv::Mat corrected(const cv::Mat& raw, const GreyCurve& curve);

struct PhotometricConfig {
  /// The paper's lambda_1 and lambda_2 as a share of what the pairs tell of gain and bias, so that they neither vanish
  /// nor rule with their number. They act on the whole curve, not on its change since the last keyframe: errors that
  /// are handed over from keyframe to keyframe fade within 1/leak of them instead of adding up without bound.
  double leak = 0.0005;
  double loss_grey = 8.0;        ///< rho: Tukey's biweight of this width, which is narrowed to from 60
  int min_pairs = 12;            ///< fewer tell nothing
  double min_spread_grey = 8.0;  ///< standard deviation of the raw greys below which only the bias is found
  double least_gain = 0.2, most_gain = 5.0;
  int dark = 3, bright = 252;    ///< raw greys beyond these are clipped and tell nothing
  int curve_pairs = 60;          ///< a polyline needs as many
  double least_bend_grey = 3.0;  ///< and must differ from the line by this somewhere between its outer knots, and
  double bend_sigmas = 6.0;      ///< by so many times its own standard deviation
};

struct PhotometricFit {
  enum class Kind {
    kept,  ///< too few usable pairs, or an impossible answer: the curve before stands
    bias,  ///< the greys were too alike for a gain; the gain before stands
    affine,
    curve
  };
  GreyCurve curve;
  Kind kind = Kind::kept;
  int pairs = 0;          ///< that were not clipped
  int inliers = 0;        ///< within the loss's width
  double rms_grey = 0.0;  ///< of the inliers' residuals
};

/// Minimises sum rho(r_k) + lambda_1 (gain - 1)^2 + lambda_2 bias^2 with r_k = reference - (gain current + bias), the
/// paper's problem in its two effective unknowns, in which it is linear, by reweighted sums with a loss that
/// is narrowed from round to round (graduated non-convexity: Blake and Zisserman 1987), so that a jump of the gain
/// control is followed and false matches are not. Where the residuals show that an affine curve cannot follow (plateau
/// equalisation), a polyline of few knots is added. `before`: the last frame's curve.
PhotometricFit fit_grey_curve(std::span<const GreyPair> pairs, const GreyCurve& before,
                              const PhotometricConfig& config);

}  // namespace pllit
