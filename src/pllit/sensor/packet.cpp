#include "pllit/sensor/packet.hpp"

#include <algorithm>
#include <iterator>

namespace pllit {
namespace {

using namespace std::chrono_literals;

constexpr Duration imu_patience = 500ms;    // points wait this long for IMU data that covers them
constexpr Duration lidar_patience = 400ms;  // without points for this long, packets go on without
constexpr Duration image_patience = 150ms;  // points wait this long for an image
constexpr Duration bridge_length = 100ms;   // length of a packet with the IMU alone
constexpr Duration imu_kept_before_first_scan = 5s;
constexpr std::size_t images_kept = 20;  // where nothing else comes

/// Takes the points of `scan` that are not later than `end` out of it.
LidarScan split_off(LidarScan& scan, Time end) {
  const auto count = std::ranges::upper_bound(scan.offsets, end - scan.start) - scan.offsets.begin();
  LidarScan head{.start = scan.start, .points_L = {}, .offsets = {}, .intensity = {}};
  const auto move_head = [count](auto& from, auto& to) {
    if (from.empty()) return;
    to.assign(from.begin(), from.begin() + count);
    from.erase(from.begin(), from.begin() + count);
  };
  move_head(scan.points_L, head.points_L);
  move_head(scan.offsets, head.offsets);
  move_head(scan.intensity, head.intensity);
  move_head(scan.rings, head.rings);
  return head;
}

void append(LidarScan& scan, const LidarScan& more) {
  const Duration later = more.start - scan.start;
  scan.points_L.insert(scan.points_L.end(), more.points_L.begin(), more.points_L.end());
  std::ranges::transform(more.offsets, std::back_inserter(scan.offsets), [=](Duration d) { return d + later; });
  scan.intensity.insert(scan.intensity.end(), more.intensity.begin(), more.intensity.end());
  scan.rings.insert(scan.rings.end(), more.rings.begin(), more.rings.end());
}

/// Offsets count from the first point, which need not be where the scan began.
void begin_at_first_point(LidarScan& scan) {
  const Duration first = scan.offsets.front();
  scan.start += first;
  for (Duration& offset : scan.offsets) offset -= first;
}

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

void PacketAssembler::push(CameraFrame image) {
  if (!config_.images) return;
  image.time += camera_delay_;
  if ((last_end_ && image.time <= *last_end_) || (last_image_ && image.time <= *last_image_)) {
    ++counts_.images_too_late;
    return;
  }
  if (last_image_ && image.time - *last_image_ < config_.image_spacing) return;
  last_image_ = image.time;
  images_.push_back(std::move(image));
  if (images_.size() > images_kept) images_.pop_front();
}

Time PacketAssembler::newest() const {
  Time time{Duration::min()};
  if (!imu_.empty()) time = std::max(time, imu_.back().time);
  if (!scans_.empty()) time = std::max(time, scans_.back().end());
  return time;
}

/// Whether the next packet ends at the first image rather than at the end of the first scan.
bool PacketAssembler::image_ends_next(Time scan_end) const {
  return !images_.empty() && images_.front().time <= scan_end + image_patience;
}

/// Where the next packet ends, if it is time for one.
std::optional<Time> PacketAssembler::next_end(bool no_more_comes) {
  const auto covered = [&](Time end) {
    return no_more_comes || (!imu_.empty() && imu_.back().time >= end) || newest() - end > imu_patience;
  };
  // The run begins with the first scan: images before its points have nothing to be placed against.
  if (!last_end_) {
    if (scans_.empty()) return std::nullopt;
    while (!images_.empty() && images_.front().time <= scans_.front().start) images_.pop_front();
  }
  if (scans_.empty() ? !images_.empty() : image_ends_next(scans_.front().end())) {
    const Time end = images_.front().time;
    const bool points_reach_it = !scans_.empty() && scans_.back().end() >= end;
    if (points_reach_it || no_more_comes || newest() - end > lidar_patience)
      return covered(end) ? std::optional(end) : std::nullopt;
    return std::nullopt;
  }
  if (scans_.empty()) return std::nullopt;
  const Time end = scans_.front().end();
  const bool image_may_come = config_.images && images_.empty() && !no_more_comes && newest() - end <= image_patience;
  return !image_may_come && covered(end) ? std::optional(end) : std::nullopt;
}

std::optional<SensorPacket> PacketAssembler::pop() {
  if (const auto end = next_end(false)) return packet_until(*end);
  const bool silent = scans_.empty() && images_.empty();
  if (silent && last_end_ && !imu_.empty() && imu_.back().time - *last_end_ > lidar_patience)
    return packet_until(*last_end_ + bridge_length);
  return std::nullopt;
}

std::optional<SensorPacket> PacketAssembler::flush() {
  if (auto packet = pop()) return packet;
  if (const auto end = next_end(true)) return packet_until(*end);
  return std::nullopt;
}

/// All points up to `end`, as one sweep.
std::optional<LidarScan> PacketAssembler::points_until(Time end) {
  std::optional<LidarScan> sweep;
  while (!scans_.empty()) {
    const bool whole = scans_.front().end() <= end;
    LidarScan part = whole ? std::move(scans_.front()) : split_off(scans_.front(), end);
    if (whole) scans_.pop_front();
    if (!part.points_L.empty()) {
      if (sweep)
        append(*sweep, part);
      else
        sweep = std::move(part);
    }
    if (!whole) break;
  }
  if (sweep && config_.images) begin_at_first_point(*sweep);
  return sweep;
}

SensorPacket PacketAssembler::packet_until(Time end) {
  if (!last_end_)
    while (imu_.size() > 1 && imu_[1].time <= scans_.front().start) imu_.pop_front();
  SensorPacket packet{.end = end, .imu = {}, .scan = points_until(end), .image = std::nullopt};
  if (!images_.empty() && images_.front().time == end) {
    packet.image = std::move(images_.front());
    images_.pop_front();
  }
  const auto after = std::ranges::lower_bound(imu_, end, {}, &ImuSample::time);
  packet.imu.assign(imu_.begin(), after == imu_.end() ? after : after + 1);
  // The last sample before the end stays: the next packet interpolates from it.
  imu_.erase(imu_.begin(), after == imu_.begin() ? after : after - 1);
  last_end_ = end;
  return packet;
}

}  // namespace pllit
