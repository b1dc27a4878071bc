// What an image shows of surfaces whose points are known: which of them are really seen, and how bright they are.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

#include "pllit/geometry/camera.hpp"
#include "pllit/geometry/lie.hpp"

namespace pllit {

/// One point of a surface in one image.
struct SurfaceObservation {
  Vector3d p_W;                   ///< m
  Eigen::Vector2f pixel_px;       ///< where it was read, distorted
  float intensity = 0.0F;         ///< calibrated, in the map's unit
  float dip = 0.0F, rise = 0.0F;  ///< how much less and more than that the image shows within SamplingConfig::aim_px
  float doubt = 0.0F;             ///< of the calibration there, one sigma, in the map's unit
  bool saturated = false;         ///< at least so bright
  float raw = 0.0F;               ///< as the camera gave it, of the nearest pixel
  float cos_incidence = 1.0F;     ///< between ray and normal; 1 where the normal is not known
  float range_m = 0.0F;           ///< from the camera
  float footprint_m = 0.0F;       ///< side of a pixel on a surface that faces the camera
};

struct SamplingConfig {
  double min_range_m = 0.3, max_range_m = 10.0;
  double min_cos_incidence = 0.42;  ///< 65 degrees: beyond about 60 emissivity falls
  int border_px = 8;                ///< of the image, left out
  int cell_px = 4;                  ///< of the grid in which depths are compared
  /// A point within so many pixels of a nearer surface is not used: rays that pass it by may hit the other one, for
  /// calibration and clocks are imperfect. Nor is one within so many more metres, at that surface's range: its points
  /// lie so far apart, and from close by there are many pixels between them.
  int shadow_px = 8;
  double shadow_m = 0.05;
  int aim_px = 4;   ///< most that a point is read off where it is: calibration, clocks, width of the LiDAR's beam
  int edge_px = 3;  ///< nor is one within so many pixels of a farther one, where the image mixes the two
  double depth_step_m = 0.08;       ///< what makes one surface nearer than another: so far out of its plane ...
  double depth_step_share = 0.035;  ///< ... or where that is not known, nearer by it and this share of the range
};

/// Points with unit normals (zero where unknown), in W, and whether the last scans measured them; equally many of each,
/// or none at all.
struct SurfacePoints {
  std::vector<Vector3f> points_W, normals_W;
  std::vector<std::uint8_t> fresh{};
};

/// Images of one exposure, of the camera's size: calibrated CV_32FC1, raw CV_8UC1 or CV_16UC1.
struct ImagePair {
  cv::Mat calibrated, raw;
};

/// A bolometer's pixels forget what they saw within a few time constants: what passed over them shows still.
struct Smear {
  SE3 T_W_C_before;   ///< the camera's pose one time constant before the image
  float most = 0.0F;  ///< a point over which more than that is smeared is not used, in the unit of the images
};

/// The points that the image shows: in range, inside the image, not hidden, away from depth edges, not at a grazing
/// angle, nor smeared. In the order of `points`. Intensities are read bilinearly, dips and rises in the image smoothed
/// over 3 x 3 pixels, for noise is neither.
std::vector<SurfaceObservation> sample_image(const SurfacePoints& points, const SE3& T_W_C, const Camera& camera,
                                             const ImagePair& images, const SamplingConfig& config,
                                             const std::optional<Smear>& smear = std::nullopt);

}  // namespace pllit
