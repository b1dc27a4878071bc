// The simulator: a rig with LiDAR, IMU and camera whose motion, surroundings and errors are known exactly. It stands in
// for a recording wherever events are read.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sensor/rig.hpp"
#include "pllit/sim/boxes/planes_world.hpp"
#include "pllit/sim/config.hpp"
#include "pllit/sim/image_truth.hpp"
#include "pllit/sim/motion/imu.hpp"
#include "pllit/sim/scene_truth.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit {

/// Of everything that the simulator makes: raised when the same address gives other bytes.
inline constexpr int kSimulatorVersion = 6;

/// Events in the order received: IMU samples at their time, scans when their turn is complete (after an IMU sample of
/// the same time), images at theirs. They are made as they are asked for, so memory does not grow with the duration;
/// the same configuration gives the same bytes.
class Simulation : public EventSource {
 public:
  /// `path`: the poses in the file that config.motion names. Input errors: such a
  /// path is missing or cannot be driven, no room for a finding, a wrong IMU's name.
  /// The configuration's values lie in the ranges that parse_sim_config() keeps to.
  static Expected<Simulation> make(const SimConfig& config, const std::optional<Trajectory>& path = std::nullopt);
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation() override;

  Expected<std::optional<SensorEvent>> next() override;
  double progress() const override;

  /// What the estimator may know: extrinsics, noise and ranges. The same for an ideal simulation, whose sensors are
  /// better.
  const Rig& rig() const;
  const std::string& rig_name() const;
  /// Of the camera, where there is one.
  bool is_thermal() const;
  const Motion& motion() const;
  /// The boxes of a box scene.
  const PlanesWorld& boxes() const;

  /// True poses at all true IMU times, faults or not.
  Trajectory truth() const;
  /// True biases at the same times.
  std::vector<StampedImuBias> true_biases() const;
  /// What is unknown to the estimator; first sightings as far as the simulation has run.
  SceneTruth scene_truth() const;
  /// What the image that next() has just returned shows. Only for worlds with images, without faults.
  ImageTruth image_truth(const TruthWanted& wanted);

 private:
  struct Parts;
  explicit Simulation(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// Opens sim:SCENE?key=value&..., described at parse_sim_config(), where no file is named.
Expected<Simulation> open_simulation(std::string_view source);

}  // namespace pllit
