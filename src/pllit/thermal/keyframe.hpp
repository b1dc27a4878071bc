// An image that later ones are matched with, and the matches.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/geometry/lie.hpp"
#include "pllit/thermal/features.hpp"

namespace pllit {

/// How far a feature is, from LiDAR points around its ray.
struct FeatureDepth {
  double range_m = 0.0;                    ///< along the ray
  double sigma_m = 0.0;                    ///< standard deviation of that
  Vector3d normal_C = -Vector3d::UnitZ();  ///< unit, of the surface, towards the camera
};

/// The vectors over points are as long as features.points_px.
struct Keyframe {
  std::uint32_t id = 0;
  Time time{};
  SE3 T_W_C = SE3::Identity();
  Features features{};
  cv::Mat image{};             ///< image_for_alignment() of what they were found in, greys not calibrated
  std::vector<float> greys{};  ///< calibrated, at the points
  cv::Mat greys_around{};      ///< calibrated, at the points and around them (photometric_chain.hpp)
  std::vector<std::optional<FeatureDepth>> depths{};  ///< of the points; nothing where the LiDAR saw none
};

struct PointMatch {
  std::size_t keyframe = 0;  ///< index in the window
  int reference = 0;         ///< index of the keyframe's point
  int current = 0;           ///< index of the current image's point
  float distance = 0.0F;     ///< of the descriptors
  double line_px = -1.0;     ///< distance to the matched line that it lies on in both images; negative: on none
};

/// Where a keyframe's point of known depth shows in the image now.
struct PointTrack {
  std::size_t keyframe = 0;  ///< index in the window
  int reference = 0;         ///< index of the keyframe's point
  Eigen::Vector2f at_px = Eigen::Vector2f::Zero();
  bool aligned = false;   ///< to a fraction of a pixel (alignment.hpp); otherwise where a feature was found
  double line_px = -1.0;  ///< as of the match, where there is one
};

struct LineMatch {
  std::size_t keyframe = 0;
  int reference = 0, current = 0;  ///< indices of the lines
  int shared_points = 0;           ///< matched points that lie on both
};

/// What one image shares with the keyframes of a window.
struct Tracks {
  std::vector<PointMatch> points;  ///< of features with features
  std::vector<PointTrack> tracked;
  std::vector<LineMatch> lines;
};

}  // namespace pllit
