// The analytic simulator: plane worlds seen by a spinning LiDAR, and an IMU, on a rig whose motion is known exactly.
// It makes no images. It stands in for a recording wherever events are read.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sensor/rig.hpp"
#include "pllit/sim/config.hpp"
#include "pllit/sim/imu.hpp"
#include "pllit/sim/lidar.hpp"
#include "pllit/sim/scenes.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

/// Events in the order received: IMU samples at their time, scans when their turn is complete (after an IMU sample of
/// the same time). They are made as they are asked for, so memory does not grow with the duration; the same
/// configuration gives the same bytes.
class Simulation : public EventSource {
 public:
  /// The configuration's values lie in the ranges that parse_sim_config() keeps to.
  explicit Simulation(const SimConfig& config);

  Expected<std::optional<SensorEvent>> next() override;
  double progress() const override;

  /// What the estimator may know: extrinsics, noise and ranges. The same for an ideal simulation, whose sensors are
  /// better.
  const Rig& rig() const { return rig_; }
  const PlanesWorld& world() const { return scene_.world; }
  const Motion& motion() const { return motion_; }

  /// True poses at all true IMU times, faults or not.
  Trajectory truth() const;
  /// True biases at the same times.
  std::vector<StampedImuBias> true_biases() const;

 private:
  ImuStream fresh_imu() const;
  Time next_scan_end() const;
  bool finished() const;
  Time next_made_time() const;
  void make_next();
  void make_imu_sample();
  void make_scan();
  void deliver(SensorEvent event, double t_s);

  SimConfig config_;
  Rig rig_;
  Scene scene_;
  Motion motion_;
  Time end_;
  SpinningLidar lidar_;
  ImuStream imu_;
  std::int64_t imu_index_ = 0, scan_index_ = 0;
  std::deque<SensorEvent> pending_;  // by time received
  Time delivered_until_;
};

/// Opens sim:SCENE?key=value&..., described at parse_sim_config().
Expected<Simulation> open_simulation(std::string_view source);

}  // namespace pllit
