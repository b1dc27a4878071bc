// Greys that mean the same from frame to frame: each image's curve from the keyframes that it is matched with.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

#include "pllit/thermal/keyframe.hpp"
#include "pllit/thermal/photometric.hpp"

namespace pllit {

/// Raw greys (or counts) at each point and at eight places 6 px around it, a row a point, CV_32FC1: between pixels
/// bilinearly, from an image that is slightly blurred. The places around are there because points lie on edges, where a
/// fraction of a pixel moves the grey most, and because a curve needs the greys on both sides; on steep edges and next
/// to clipped pixels they are NaN, as is all outside the image. image: CV_8UC1 or CV_16UC1.
cv::Mat greys_around(const cv::Mat& image, std::span<const Eigen::Vector2f> points_px);

/// Puts the greys of its image into a keyframe, through the image's curve. around: greys_around() the image's points,
/// of which the keyframe's are the first.
void set_greys(Keyframe& keyframe, const cv::Mat& around, const GreyCurve& curve);

/// The greys that matches tell of: calibrated in their keyframe, raw in the image now. At most `most`, evenly over the
/// matches.
std::vector<GreyPair> grey_pairs(const Tracks& tracks, std::span<const Keyframe> window, const cv::Mat& around_now,
                                 int most);

struct ChainConfig {
  PhotometricConfig fit{};
  int most_pairs = 1500;
  /// Calibrated images may be stretched or squeezed by this factor and shifted by this many greys against the camera's
  /// own; beyond, they become too pale or too clipped to find features in.
  double most_stretch = 1.6, most_shift_grey = 60.0;
};

/// The chain's state between two images.
struct PhotometricChain {
  GreyCurve curve;    ///< of the last image: what the next one is corrected with before features are sought
  cv::Mat quantiles;  ///< of the last image's calibrated greys; empty before the first image
};

/// The state to correct an image with that comes after a shutter event or a gap, when the last image's curve says
/// nothing about it: the curve that gives it the calibrated greys of the last image, quantile by quantile, in gain and
/// bias. The same chain where there was no image. grey: CV_8UC1.
PhotometricChain restarted(const PhotometricChain& chain, const cv::Mat& grey);

struct ChainStep {
  PhotometricChain chain;
  PhotometricFit fit;
};

/// An image's own curve, from its matches with all keyframes of the window (more than the paper's single reference:
/// what one hand-over gets wrong the others correct), starting at the chain's. grey: CV_8UC1, raw.
ChainStep advanced(const PhotometricChain& chain, const cv::Mat& grey, const cv::Mat& around_now, const Tracks& tracks,
                   std::span<const Keyframe> window, const ChainConfig& config);

/// The greys that all images are brought to are those of the first image, which may have been a poor one: taken while
/// the camera's exposure was settling, or of another scene. Where the chain's curve stretches, squeezes or shifts by
/// more than allowed, the last image's greys take their place: the window's greys are brought to them, and the curve
/// becomes the identity but for its bend. What it calibrates to changes, what it says of differences does not.
PhotometricChain in_fresh_greys(const PhotometricChain& chain, std::span<Keyframe> window, const ChainConfig& config);

}  // namespace pllit
