// Packets: the data of one filter step, assembled once from the stream of events. All alignment in time lives here.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/sensor/rig.hpp"

namespace pllit {

/// IMU samples from the last one before the previous packet's end to the first one after this end, the LiDAR points
/// between the two ends as one sweep, and the image taken at this end. A packet without a scan bridges a silent LiDAR.
struct SensorPacket {
  Time end;
  std::vector<ImuSample> imu;
  std::optional<LidarScan> scan;
  std::optional<CameraFrame> image = std::nullopt;
};

/// What the assembler had to leave out.
struct AssemblerCounts {
  int imu_not_finite = 0;
  int imu_not_ascending = 0;  ///< duplicates and steps back in time
  int scans_too_late = 0;     ///< ended before the previous packet did
  int scans_empty = 0;
  int images_too_late = 0;  ///< taken before the previous packet's end, or not in order
};

/// Where packets end. Without images, at the ends of scans. With them, at the images, and the scans are cut there, so
/// that LiDAR and image measure the same state; where no image comes, at the ends of scans after all.
struct AssemblerConfig {
  bool images = false;
  Duration image_spacing = std::chrono::milliseconds(70);  ///< images that follow sooner are left out
};

class PacketAssembler {
 public:
  explicit PacketAssembler(const Rig& rig, const AssemblerConfig& config = {})
      : lidar_delay_(rig.lidar_delay), camera_delay_(rig.camera_delay), config_(config) {}

  void push(const ImuSample& sample);
  void push(LidarScan scan);
  void push(CameraFrame image);
  /// The next packet that is complete: its data reaches its end, or has been silent for too long to wait.
  std::optional<SensorPacket> pop();
  /// The next packet of what is left when no more data comes.
  std::optional<SensorPacket> flush();

  const AssemblerCounts& counts() const { return counts_; }

 private:
  std::optional<Time> next_end(bool no_more_comes);
  bool image_ends_next(Time scan_end) const;
  SensorPacket packet_until(Time end);
  std::optional<LidarScan> points_until(Time end);
  Time newest() const;

  Duration lidar_delay_, camera_delay_;
  AssemblerConfig config_;
  std::deque<ImuSample> imu_;
  std::deque<LidarScan> scans_;  ///< the first may have lost its beginning to the packet before
  std::deque<CameraFrame> images_;
  std::optional<Time> last_end_, last_image_;
  AssemblerCounts counts_;
};

}  // namespace pllit
