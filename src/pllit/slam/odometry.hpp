// The odometry: packets in, frame estimates out.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "pllit/base/arena.hpp"
#include "pllit/sensor/packet.hpp"
#include "pllit/slam/config.hpp"
#include "pllit/slam/drift.hpp"
#include "pllit/slam/health.hpp"
#include "pllit/slam/stage_clock.hpp"
#include "pllit/slam/vision.hpp"

namespace pllit {

/// A camera's mount with the covariance of its errors.
struct RefinedMount {
  CameraMount mean;
  MountMatrix covariance = MountMatrix::Zero();
};

/// The estimate at the end of one packet, and what led to it.
struct FrameEstimate {
  Estimate posterior;  ///< its covariance holds against the map around the robot
  PoseDoubt doubt;     ///< what of the pose is known against that map, and of the map against the origin
  Health health;
  FrameFacts facts;
  PointCloud cloud;                                  ///< the scan's points in I, de-skewed; empty without a scan
  std::optional<CameraFrame> image = std::nullopt;   ///< of this moment, where images are looked at ...
  std::optional<RefinedMount> mount = std::nullopt;  ///< ... how its camera is tied to the rig, as refined so far ...
  SE3 T_I_C = SE3::Identity();  ///< ... and where the camera was when it took it, seen from I of this moment
  StageTimes stage_ms{};

  /// The cloud's points in W.
  std::vector<Vector3f> points_W() const;
  /// Covariance of (theta, p) in W against the origin.
  Matrix6 pose_covariance() const { return doubt.total(); }
};

class Odometry {
 public:
  /// Without `vision` images are not looked at.
  Odometry(const Rig& rig, const Config& config, std::unique_ptr<Vision> vision = nullptr);

  /// Takes the next packet. Returns the frames that are now known: none while starting up, all of them once started,
  /// then one a packet. Errors: no start is possible, an image is not what the configuration says.
  Expected<std::vector<FrameEstimate>> process(SensorPacket packet);

  /// How it started, once it has.
  const std::optional<Start>& start() const { return start_; }
  const PlaneMap& map() const { return map_; }

 private:
  Expected<std::optional<Start>> try_start() const;
  bool scans_show_no_turn(const Start& start) const;
  void begin(const Start& start);
  Start with_settled_velocity(Start start) const;
  Expected<FrameEstimate> step(const SensorPacket& packet);
  UpdateResult match(const Estimate& predicted, const PointCloud& points, FrameFacts& facts);
  void advance_to(const SmoothedEnd& end);
  void extend_map(const PointCloud& points, const SE3& T_W_I, FrameFacts& facts);
  std::vector<ImuSample> in_si_units(std::vector<ImuSample> imu) const;

  Rig rig_;
  Config config_;
  Arena arena_;
  PlaneMap map_;
  MapDrift drift_;
  std::vector<SensorPacket> waiting_;  ///< until started
  std::optional<Start> start_;
  Estimate estimate_;
  std::unique_ptr<Vision> vision_;
  DegenerateDirections unobserved_;  ///< of the last scan
  Time last_match_, last_held_;      ///< by a scan; by an image, where the scan does not hold the pose
  int unmatched_ = 0;                ///< scans in a row
  std::size_t mapped_points_ = 0;    ///< since the map was begun
};

/// Covariance of the pose of `b` seen from `a` (theta, p in W, about a's position): what the map walked between them
/// and the two matches.
Matrix6 relative_pose_covariance(const FrameEstimate& a, const FrameEstimate& b);

}  // namespace pllit
