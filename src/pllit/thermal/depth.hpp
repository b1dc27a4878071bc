// Depth of image features from LiDAR points (the paper's "LiDAR-Thermal Depth Association").
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pllit/geometry/camera.hpp"
#include "pllit/state/line_landmark.hpp"
#include "pllit/thermal/keyframe.hpp"

namespace pllit {

struct DepthConfig {
  double bin_deg = 0.15;             ///< of the range image at its middle; a bin keeps its nearest return
  double reach_deg = 1.5;            ///< neighbours of a feature are at most this far from its ray
  double patch_m = 0.10;             ///< and at most this far across it, as long as that leaves enough of them
  double edge_deg = 0.3;             ///< a ray may pass beside the points of its surface by as much, not farther
  double clear_deg = 0.8;            ///< a ray to a surface passes nearer ones by at least as much
  double hiding_deg = 0.6;           ///< a point with nearer ones on opposite sides within this angle is hidden
  double jump_share = 0.05;          ///< ranges that differ by more than this share are different surfaces
  double jump_m = 0.15;              ///< ... and by more than this
  double range_sigma_m = 0.02;       ///< of a return, along its ray
  double bearing_sigma_px = 0.5;     ///< of a feature
  double residual_share = 0.003;     ///< most scatter about a surface, per range, beside 1.5 range_sigma_m
  double most_incidence_deg = 78.0;  ///< between the ray and the surface's normal
  double min_range_m = 0.4, max_range_m = 100.0;
};

/// LiDAR points as a camera sees them: the nearest return in each bin of its sphere, and none that nearer ones hide.
/// The range image is the index too: a feature's neighbours are found in rings of bins around its ray, the same ones
/// that a k-d tree on the unit sphere finds, without a tree to build for each image.
class DepthImage {
 public:
  /// points_P: in any frame P, metres (floats hold over kilometres if P's origin is near), taken within a second or so
  /// and brought there with posterior poses. T_C_P: of the camera at the image's time.
  DepthImage(std::span<const Vector3f> points_P, const SE3& T_C_P, const Camera& camera, const DepthConfig& config);
  /// The same from several scans.
  DepthImage(std::span<const std::span<const Vector3f>> scans_P, const SE3& T_C_P, const Camera& camera,
             const DepthConfig& config);

  /// Range along the feature's ray to the plane through its neighbours. Where ranges jump, the feature belongs to the
  /// nearer surface, which owns the edge; nothing where the ray passes beside it (no plane bridges a jump), where too
  /// few points lie around the ray, where they scatter about their plane, or where that is seen too flatly.
  std::optional<FeatureDepth> at(const Eigen::Vector2d& pixel_px) const;

  /// The points that are neither behind others nor out of the image.
  std::vector<Vector3f> points_C() const;

 private:
  class Neighbours;

  template <class T>
  using Bins = Eigen::Array<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Eigen::Vector2f bin_of(const Vector3f& p_C, float range_m) const;
  void insert(std::span<const Vector3f> points_P, const SE3& T_C_P);
  void hide();
  void collect(const Vector3f& ray, Neighbours& neighbours) const;

  Camera camera_;
  DepthConfig config_;
  float bin_;                     ///< side, in the plane that the sphere is projected to
  float least_bin_rad_;           ///< angle that the smallest bin covers; at the axis, the largest, it is bin_deg
  float least_cos_;               ///< of the angle from the axis, within the field
  Eigen::Vector2f corner_;        ///< of bin (0, 0)
  Bins<float> ranges_m_;          ///< of the nearest return; infinite where there is none
  Bins<std::int32_t> index_;      ///< of its point, where there is one
  std::vector<Vector3f> points_;  ///< in C
};

/// Points of the near surface along an observed line, `step_px` apart: the image says where the edge runs, which the
/// LiDAR's beam blurs, and the surface's own points how far it is. line_sigma_px: of the line across itself.
std::vector<EdgePoint> points_along(const LineSegment& line, const DepthImage& depths, const Camera& camera,
                                    double line_sigma_px = 1.0, double step_px = 6.0);

}  // namespace pllit
