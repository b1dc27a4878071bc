// Images of moments when the rig hardly turned, with the LiDAR points that belong on them: what a wrong extrinsic or
// delay shows in at a glance.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sensor/rig.hpp"

namespace pllit {

struct CalmMoment {
  Time time;       ///< of the image, IMU clock
  cv::Mat counts;  ///< as they came
  double turn_rps = 0.0;
  std::vector<Vector3f> points_C;  ///< one scan, as from the rig's attitude at the image's time
};

/// Picks at most `most` moments, spread over the recording; it keeps no other images. Events in the order received.
class CalmMoments {
 public:
  explicit CalmMoments(const Rig& rig, std::size_t most = 6) : rig_(rig), most_(most) {}
  void add(const SensorEvent& event);
  /// Oldest first.
  std::vector<CalmMoment> moments() const;

 private:
  struct Turn {
    Time time;
    Eigen::Vector3d gyro_rps;
  };
  void match(const LidarScan& scan);
  std::optional<Turn> turn_at(Time time) const;
  std::size_t span_of(Time time);

  Rig rig_;
  std::size_t most_;
  double span_s_ = 2.0;           ///< one moment is kept for each; doubled when there are too many
  std::optional<Time> start_;     ///< of the first image
  std::deque<Turn> turns_;        ///< of the last second
  std::deque<CameraFrame> open_;  ///< images whose scan has not come yet
  std::vector<std::optional<CalmMoment>> kept_;
};

}  // namespace pllit
