// What the camera adds to the odometry: keyframes, tracks, and the refinement of the LiDAR's posterior (the paper's
// "Thermal-Visual Measurement Model" and stage II of its sequential filter).
#pragma once

#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pllit/sensor/rig.hpp"
#include "pllit/slam/image_facts.hpp"
#include "pllit/slam/line_tracks.hpp"
#include "pllit/slam/stage_clock.hpp"
#include "pllit/slam/vision_config.hpp"
#include "pllit/state/clones.hpp"
#include "pllit/thermal/keyframe.hpp"
#include "pllit/thermal/observations.hpp"

namespace pllit {

class Vision {
 public:
  /// What the odometry knows at an image's time.
  struct Moment {
    Estimate prior;
    Vector3d rate_I = Vector3d::Zero();  ///< how the rig turns, rad/s
  };
  /// The rig must have a camera.
  Vision(const Rig& rig, const VisionConfig& config, std::unique_ptr<FeatureExtractor> extractor);

  /// Begins to look for features in a thread of its own; refine() with the same image comes next.
  void look_at(const CameraFrame& image);
  /// The state's error has become J times what it was, plus what keyframes know nothing of.
  void carry(const Matrix18& J_now_before);
  /// LiDAR points in I at `time`: where features will find their depth.
  void add_points(const std::vector<Vector3f>& points_I, const SE3& T_W_I, Time time);
  /// The state after this image; the prior where it is of no use. Errors are the extractor's.
  Expected<Estimate> refine(const CameraFrame& image, const Moment& moment, ImageFacts& facts, StageClock& clock,
                            Arena& arena);
  /// Begins, in a thread of its own, to extend keyframes and lines by the image just refined; what comes next waits for
  /// it, but for look_at(). The arena must live as long.
  void learn(Arena& arena);
  /// Forgets what was built on poses that are not to be trusted any more.
  void restart();

  /// As refined so far.
  const CameraMount& mount() const { return clones_.mount; }
  MountMatrix mount_covariance() const { return clones_.mount_covariance(); }

 private:
  /// What is found in an image without knowing where it was taken.
  struct Look {
    ImageVerdict verdict;
    cv::Mat counts{}, around{};  ///< one channel, raw; greys_around() the points
    PhotometricChain chain{};    ///< that it was corrected with
    std::optional<CountRange> range{};
    Features features{};
    cv::Mat image{};  ///< image_for_alignment() of it, greys not calibrated
  };
  Expected<Look> look(const CameraFrame& image) const;
  ImageObservations observe(const Features& features, const Tracks& tracks, const Moment& moment) const;
  DepthImage depths_at(const SE3& T_W_C) const;
  Estimate update(const Moment& moment, const ImageObservations& observations, ImageFacts& facts);
  /// What a refined image leaves to be learned.
  struct Lesson {
    Look look;
    Tracks tracks;
    Estimate posterior;
    Exposure exposed;
  };
  void finish_learning();
  void extend_maps(const Lesson& lesson, Arena& arena);
  void keep(const Lesson& lesson, const DepthImage& depths, Arena& arena);
  bool is_calibrated(const Look& look) const;
  void let_clocks_drift(Time time);
  void drop_keyframe(std::size_t index);

  Rig rig_;
  VisionConfig config_;
  std::unique_ptr<FeatureExtractor> extractor_;
  double least_cos_;  ///< of the angle from the axis to the image's corners
  std::future<Expected<Look>> looking_;
  ImageHistory history_;
  PhotometricChain chain_;
  std::optional<CountRange> range_;
  std::vector<Keyframe> keyframes_;
  LineTracks lines_;
  Time lines_seen_{};
  Clones clones_;  ///< the mount, and the poses of the keyframes in their order
  Time mount_time_{};
  struct SeenPoints {
    Time time;
    std::vector<Vector3f> points_W;
  };
  std::deque<SeenPoints> points_;
  std::uint32_t next_id_ = 0;
  double correction_ = 1.0;  ///< running mean
  std::optional<Lesson> lesson_;
  std::future<void> learning_;  ///< last, so that it ends before the rest goes
};

/// Nothing where the rig has no camera or the configuration wants none. Errors: the extractor's.
Expected<std::unique_ptr<Vision>> make_vision(const Rig& rig, const VisionConfig& config);

}  // namespace pllit
