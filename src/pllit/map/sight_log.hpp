// What was seen from where: coarse range images of the past, which tell whether a surface is new.
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "pllit/base/time.hpp"
#include "pllit/map/image_sampling.hpp"

namespace pllit {

struct SightConfig {
  int cell_px = 8;
  double max_range_m = 40.0;
  double margin_m = 0.12, margin_share = 0.03;  ///< in depth, what is one surface; the share is of the range
  double spacing_m = 0.25, turn_rad = 0.15;     ///< a sight is kept where the camera has moved or turned so far
  int most = 600;                               ///< sights kept; then the oldest goes
};

/// The nearest surface in each cell of an image, and how bright it was.
struct Sight {
  Time time;
  SE3 T_W_C = SE3::Identity();
  std::vector<float> range_m;    ///< infinite where no point fell
  std::vector<float> intensity;  ///< in the map's unit
};

/// What a sight says about a point.
struct PointSight {
  enum class Kind {
    unknown,  ///< out of the image, or no surface was measured there
    hidden,   ///< something stood before it
    surface,  ///< there was a surface
    free      ///< a surface behind it was seen through where it is
  };
  Kind kind = Kind::unknown;
  float behind = 0.0F;  ///< intensity of what was seen there
};

/// Points in one image.
Sight sight_of(Time time, const SE3& T_W_C, std::span<const Vector3f> points_W, const Camera& camera,
               const SightConfig& config);
/// The same with what is seen there; calibrated: CV_32FC1.
Sight sight_of(Time time, const SE3& T_W_C, std::span<const Vector3f> points_W, const cv::Mat& calibrated,
               const Camera& camera, const SightConfig& config);
PointSight look_at(const Sight& sight, const Vector3d& p_W, const Camera& camera, const SightConfig& config);

/// How often earlier sights saw a surface at a point, and how often through it.
struct SightEvidence {
  int surface = 0, free = 0;
  float behind = 0.0F;  ///< mean intensity of what was seen through it
  bool was_free() const { return free >= 2 && free > 3 * surface; }
};

class SightLog {
 public:
  SightLog(const Camera& camera, const SightConfig& config) : camera_(camera), config_(config) {}

  /// Keeps the sight where the camera has moved or turned enough since the last one kept.
  void add(Sight sight);
  SightEvidence evidence(const Vector3d& p_W, Time before) const;
  const Camera& camera() const { return camera_; }
  const SightConfig& config() const { return config_; }
  std::size_t size() const { return sights_.size(); }

 private:
  Camera camera_;
  SightConfig config_;
  std::deque<Sight> sights_;
};

}  // namespace pllit
