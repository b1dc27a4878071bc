// What to simulate, and its text form: sim:SCENE?key=value&key=value
#pragma once

#include <cstdint>
#include <string_view>

#include "pllit/base/error.hpp"

namespace pllit {

/// Seconds since the start, [from, to); empty as it comes.
struct FaultInterval {
  double from_s = 0.0, to_s = 0.0;
  bool contains(double t_s) const { return t_s >= from_s && t_s < to_s; }
};

/// What goes wrong, and when. An IMU sample is in an interval by its true time, a scan by the true end of its turn.
struct SimFaults {
  FaultInterval imu_gap;      ///< IMU samples are lost
  FaultInterval lidar_gap;    ///< scans are lost: a silent LiDAR
  FaultInterval time_back;    ///< stamps of both sensors are 1 s too early; the times of receipt are not
  FaultInterval duplicates;   ///< every message comes twice
  FaultInterval imu_nan;      ///< IMU samples hold NaN
  FaultInterval late_scans;   ///< scans are received late_by_s after the end of their turn
  FaultInterval swapped_imu;  ///< neighbouring IMU samples change places
  double late_by_s = 0.08;
};

struct SimConfig {
  enum class Place { room, corridor, outdoor };
  enum class Carried { walk, shake };
  enum class Lidar { ring32, ring16 };

  Place scene = Place::room;
  Carried motion = Carried::walk;
  Lidar lidar = Lidar::ring32;
  std::uint64_t seed = 1;
  double duration_s = 30.0;
  double imu_rate_hz = 200.0;
  double speed_mps = 1.0;
  bool ideal = false;       ///< no noise and no bias
  bool accel_in_g = false;  ///< the accelerometer reports g instead of m/s2, as some LiDARs' own IMUs do
  SimFaults faults;
};

/// Reads sim:SCENE?key=value&... with scene room, corridor or outdoor. Keys: seed; duration (s, 3 to 36000); imu_rate
/// (Hz, 10 to 1000); speed (m/s, 0.1 to 3); motion=walk|shake; lidar=ring32|ring16; ideal=0|1; accel_unit=mps2|g; and
/// the faults by their names above, each FROM:TO in seconds. What is unknown, repeated or out of range is an input
/// error that says what would be right.
Expected<SimConfig> parse_sim_config(std::string_view source);

}  // namespace pllit
