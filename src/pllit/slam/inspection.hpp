// What a recording is like: rates, gaps, clocks, units. The doctor's eyes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pllit/slam/config.hpp"
#include "pllit/slam/time_offset.hpp"

namespace pllit {

/// The stamps of one sensor.
struct StreamFacts {
  int count = 0;
  double rate_hz = 0.0;  ///< from the median interval
  double longest_gap_s = 0.0;
  int gaps = 0;                 ///< intervals longer than three times the median
  int not_ascending = 0;        ///< stamps equal to or before the one before
  double delay_median_s = 0.0;  ///< time received minus stamp
  double delay_spread_s = 0.0;  ///< 95th minus 5th percentile of it
  Time first, last;
};

struct Inspection {
  StreamFacts imu, lidar, camera;
  std::optional<AccelUnit> accel_unit;    ///< nothing: in no known unit, see problems
  std::optional<Stillness> first_second;  ///< of the IMU
  double points_per_scan = 0.0;
  double scan_span_s = 0.0;  ///< median time from a scan's first to its last point
  double overlap_s = 0.0;    ///< time that IMU and LiDAR share
  TimeOffset imu_to_lidar;
  std::vector<std::string> problems;  ///< what stands in the way of a run
  std::vector<std::string> warnings;  ///< what will make it worse
};

/// Gathers events and tells what they show. Keeps stamps of all messages, but points only of the scans from which the
/// offset is estimated.
class Inspector {
 public:
  Inspector(const Rig& rig, const Config& config) : rig_(rig), config_(config) {}
  void add(const SensorEvent& event);
  Inspection finish() const;

 private:
  struct Stamps {
    std::vector<Time> stamps, received;
    void add(Time stamp, Time at) {
      stamps.push_back(stamp);
      received.push_back(at);
    }
  };
  static StreamFacts facts_of(const Stamps& stamps);
  void judge(Inspection& inspection) const;
  void judge_imu(Inspection& inspection) const;

  Rig rig_;
  Config config_;
  Stamps imu_stamps_, lidar_stamps_, camera_stamps_;
  std::vector<ImuSample> imu_;
  std::vector<LidarScan> scans_;  ///< the first ones
  std::vector<double> spans_s_;
  double points_ = 0.0;
};

}  // namespace pllit
