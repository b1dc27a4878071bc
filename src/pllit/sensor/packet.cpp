#include "pllit/sensor/packet.hpp"

#include <algorithm>

namespace pllit {
namespace {

using namespace std::chrono_literals;

constexpr Duration imu_patience = 500ms;    // a scan waits this long for IMU data that covers it
constexpr Duration lidar_patience = 400ms;  // without a scan for this long, packets go on with the IMU alone
constexpr Duration bridge_length = 100ms;   // length of such a packet
constexpr Duration imu_kept_before_first_scan = 5s;

}  // namespace

void PacketAssembler::push(const ImuSample& sample) {
  if (!sample.gyro_rps.allFinite() || !sample.accel_mps2.allFinite()) {
    ++counts_.imu_not_finite;
  } else if (!imu_.empty() && sample.time <= imu_.back().time) {
    ++counts_.imu_not_ascending;
  } else {
    imu_.push_back(sample);
    if (!last_end_ && scans_.empty())
      while (sample.time - imu_.front().time > imu_kept_before_first_scan) imu_.pop_front();
  }
}

void PacketAssembler::push(LidarScan scan) {
  if (scan.points_L.empty()) {
    ++counts_.scans_empty;
    return;
  }
  scan.start += lidar_delay_;
  const bool late = (last_end_ && scan.end() <= *last_end_) || (!scans_.empty() && scan.end() <= scans_.back().end());
  if (late)
    ++counts_.scans_too_late;
  else
    scans_.push_back(std::move(scan));
}

std::optional<SensorPacket> PacketAssembler::pop() {
  if (!scans_.empty()) {
    const Time end = scans_.front().end();
    const bool covered = !imu_.empty() && imu_.back().time >= end;
    const bool waited = scans_.back().end() - end > imu_patience;
    if (covered || waited) return scan_packet();
    return std::nullopt;
  }
  if (last_end_ && !imu_.empty() && imu_.back().time - *last_end_ > lidar_patience)
    return packet_until(*last_end_ + bridge_length);
  return std::nullopt;
}

std::optional<SensorPacket> PacketAssembler::flush() {
  if (auto packet = pop()) return packet;
  if (!scans_.empty()) return scan_packet();
  return std::nullopt;
}

SensorPacket PacketAssembler::scan_packet() {
  LidarScan scan = std::move(scans_.front());
  scans_.pop_front();
  if (!last_end_)  // the run begins with the first scan
    while (imu_.size() > 1 && imu_[1].time <= scan.start) imu_.pop_front();
  SensorPacket packet = packet_until(scan.end());
  packet.scan = std::move(scan);
  return packet;
}

SensorPacket PacketAssembler::packet_until(Time end) {
  SensorPacket packet{.end = end, .imu = {}, .scan = std::nullopt};
  const auto after = std::ranges::lower_bound(imu_, end, {}, &ImuSample::time);
  packet.imu.assign(imu_.begin(), after == imu_.end() ? after : after + 1);
  // The last sample before the end stays: the next packet interpolates from it.
  imu_.erase(imu_.begin(), after == imu_.begin() ? after : after - 1);
  last_end_ = end;
  return packet;
}

}  // namespace pllit
