// The sensors of a simulated rig, each a stream of messages.
#pragma once

#include <memory>
#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sim/boxes/scenes.hpp"
#include "pllit/sim/boxes/spinning_lidar.hpp"
#include "pllit/sim/image_truth.hpp"
#include "pllit/sim/motion/imu.hpp"
#include "pllit/sim/rigs.hpp"
#include "pllit/sim/sightings.hpp"
#include "pllit/sim/world/ray_lidar.hpp"

namespace pllit {

/// One sensor's messages in order of time.
class SimSensor {
 public:
  virtual ~SimSensor() = default;
  /// The true time at which the next ones are complete.
  virtual Time due() const = 0;
  /// Makes those; `received` is the time at which they were due.
  virtual std::vector<SensorEvent> take() = 0;
};

/// A camera's images, and what is true of the last one.
class ImageSensor : public SimSensor {
 public:
  /// Before anything else has been made.
  virtual ImageTruth truth(const TruthWanted& wanted) = 0;
};

/// A place with its rays, for all sensors of a rig.
struct Surroundings {
  std::unique_ptr<Place> place;
  RayCaster caster;
  Arena arena{0};

  Surroundings(std::unique_ptr<Place> made, double reach_m) : place(std::move(made)), caster(*place, reach_m) {}
};

/// The referents of every sensor must outlive it.
std::unique_ptr<SimSensor> imu_sensor(const Motion& motion, ImuStream stream, bool accel_in_g);
std::unique_ptr<SimSensor> box_lidar_sensor(const Motion& motion, const SpinningLidar& lidar, const PlanesWorld& world,
                                            std::uint64_t seed);
std::unique_ptr<SimSensor> lidar_sensor(const Motion& motion, const SimRig& rig, Surroundings& around,
                                        std::uint64_t seed);

struct ImageStream {
  double rate_hz = 10.0;
  bool agc = true, counts = false;  ///< of a thermal camera: what it gives out
  bool ideal = false;               ///< images have no noise and no stamps that are late
};
/// A thermal camera also tells which findings it could see first when.
std::unique_ptr<ImageSensor> thermal_sensor(const Motion& motion, const SimRig& rig, const ImageStream& stream,
                                            Surroundings& around, std::uint64_t seed, Sightings& sightings);
std::unique_ptr<ImageSensor> visible_sensor(const Motion& motion, const SimRig& rig, const ImageStream& stream,
                                            Surroundings& around, std::uint64_t seed);

}  // namespace pllit
