// Packets: the data of one filter step, assembled once from the stream of events. All alignment in time lives here.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sensor/rig.hpp"

namespace pllit {

/// IMU samples from the last one before the previous packet's end to the first one after this end, and the scan that
/// ends the packet. A packet without a scan bridges a silent LiDAR.
struct SensorPacket {
  Time end;
  std::vector<ImuSample> imu;
  std::optional<LidarScan> scan;
};

/// What the assembler had to leave out.
struct AssemblerCounts {
  int imu_not_finite = 0;
  int imu_not_ascending = 0;  ///< duplicates and steps back in time
  int scans_too_late = 0;     ///< ended before the previous packet did
  int scans_empty = 0;
};

class PacketAssembler {
 public:
  explicit PacketAssembler(const Rig& rig) : lidar_delay_(rig.lidar_delay) {}

  void push(const ImuSample& sample);
  void push(LidarScan scan);
  /// The next packet that is complete: its IMU data reaches its end, or has been silent for too long to wait.
  std::optional<SensorPacket> pop();
  /// The next packet of what is left when no more data comes.
  std::optional<SensorPacket> flush();

  const AssemblerCounts& counts() const { return counts_; }

 private:
  SensorPacket packet_until(Time end);
  SensorPacket scan_packet();

  Duration lidar_delay_;
  std::deque<ImuSample> imu_;
  std::deque<LidarScan> scans_;
  std::optional<Time> last_end_;
  AssemblerCounts counts_;
};

}  // namespace pllit
