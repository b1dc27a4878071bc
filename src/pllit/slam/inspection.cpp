#include "pllit/slam/inspection.hpp"

#include <algorithm>
#include <cmath>
#include <format>

namespace pllit {
namespace {

constexpr std::size_t scans_for_offset = 300;

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, nth);
  return *nth;
}

/// The samples with ascending stamps and finite values.
std::vector<ImuSample> clean(const std::vector<ImuSample>& imu) {
  std::vector<ImuSample> result;
  for (const ImuSample& sample : imu) {
    if (!sample.gyro_rps.allFinite() || !sample.accel_mps2.allFinite()) continue;
    if (!result.empty() && sample.time <= result.back().time) continue;
    result.push_back(sample);
  }
  return result;
}

}  // namespace

void Inspector::add(const SensorEvent& event) {
  if (const auto* sample = std::get_if<ImuSample>(&event.data)) {
    imu_stamps_.add(sample->time, event.received);
    imu_.push_back(*sample);
  } else if (const auto* scan = std::get_if<LidarScan>(&event.data)) {
    lidar_stamps_.add(scan->start, event.received);
    spans_s_.push_back(to_seconds(scan->end() - scan->start));
    points_ += static_cast<double>(scan->points_L.size());
    if (scans_.size() < scans_for_offset) scans_.push_back(*scan);
  } else if (const auto* frame = std::get_if<CameraFrame>(&event.data)) {
    camera_stamps_.add(frame->time, event.received);
  }
}

StreamFacts Inspector::facts_of(const Stamps& stamps) {
  StreamFacts facts;
  facts.count = static_cast<int>(stamps.stamps.size());
  if (facts.count == 0) return facts;
  const auto [first, last] = std::ranges::minmax(stamps.stamps);
  facts.first = first;
  facts.last = last;
  std::vector<double> intervals_s, delays_s;
  for (std::size_t i = 0; i < stamps.stamps.size(); ++i) {
    delays_s.push_back(to_seconds(stamps.received[i] - stamps.stamps[i]));
    if (i == 0) continue;
    const double interval_s = to_seconds(stamps.stamps[i] - stamps.stamps[i - 1]);
    if (interval_s <= 0.0)
      ++facts.not_ascending;
    else
      intervals_s.push_back(interval_s);
  }
  facts.delay_median_s = percentile(delays_s, 0.5);
  facts.delay_spread_s = percentile(delays_s, 0.95) - percentile(delays_s, 0.05);
  if (intervals_s.empty()) return facts;
  const double median_s = percentile(intervals_s, 0.5);
  facts.rate_hz = 1.0 / median_s;
  facts.longest_gap_s = std::ranges::max(intervals_s);
  facts.gaps = static_cast<int>(std::ranges::count_if(intervals_s, [&](double s) { return s > 3.0 * median_s; }));
  return facts;
}

Inspection Inspector::finish() const {
  Inspection inspection;
  inspection.imu = facts_of(imu_stamps_);
  inspection.lidar = facts_of(lidar_stamps_);
  inspection.camera = facts_of(camera_stamps_);
  if (inspection.lidar.count > 0) inspection.points_per_scan = points_ / inspection.lidar.count;
  inspection.scan_span_s = percentile(spans_s_, 0.5);
  judge_imu(inspection);
  judge(inspection);
  if (inspection.problems.empty()) {
    const auto rotations = lidar_rotations(scans_, rig_, config_);
    inspection.imu_to_lidar = estimate_time_offset(clean(imu_), rotations);
    const TimeOffset& offset = inspection.imu_to_lidar;
    const double configured_s = to_seconds(rig_.lidar_delay);
    if (offset.found && std::abs(offset.offset_s - configured_s) > std::max(0.02, 0.5 / inspection.imu.rate_hz))
      inspection.warnings.push_back(
          std::format("the LiDAR's clock seems {:.3f} s off; try --set rig.lidar.delay_s={:.3f}", offset.offset_s,
                      offset.offset_s));
  } else {
    inspection.imu_to_lidar.reason = "not looked for, as a run is not possible";
  }
  return inspection;
}

void Inspector::judge_imu(Inspection& inspection) const {
  if (imu_.size() < 10) return;
  auto first = clean(imu_);
  const Time end = first.empty() ? Time{} : first.front().time + from_seconds(config_.start.window_s);
  first.erase(std::ranges::find_if(first, [end](const ImuSample& s) { return s.time > end; }), first.end());
  if (first.size() < 5) return;
  const auto unit = accel_unit_of(first, config_.start.unit);
  if (!unit) {
    inspection.problems.push_back(unit.error().message);
    return;
  }
  inspection.accel_unit = *unit;
  for (ImuSample& sample : first) sample.accel_mps2 *= mps2_per(*unit);
  inspection.first_second = measure_stillness(first, config_.start);
}

void Inspector::judge(Inspection& inspection) const {
  const StreamFacts &imu = inspection.imu, &lidar = inspection.lidar;
  const auto problem = [&](std::string text) { inspection.problems.push_back(std::move(text)); };
  const auto warn = [&](std::string text) { inspection.warnings.push_back(std::move(text)); };
  if (imu.count == 0) problem("there is no IMU data");
  if (lidar.count == 0) problem("there are no LiDAR scans");
  if (imu.count == 0 || lidar.count == 0) return;

  inspection.overlap_s = to_seconds(std::min(imu.last, lidar.last) - std::max(imu.first, lidar.first));
  if (inspection.overlap_s < 2.0)
    problem(std::format("IMU and LiDAR stamps overlap for {:.1f} s only; their clocks differ by about {:.1f} s",
                        std::max(0.0, inspection.overlap_s), to_seconds(lidar.first - imu.first)));
  if (inspection.scan_span_s <= 0.0)
    warn("the scans carry no time for each point, so motion during a sweep cannot be taken out");
  if (imu.rate_hz < 50.0)
    warn(std::format("the IMU has {:.0f} Hz; 100 Hz and more make turns and shocks harmless", imu.rate_hz));
  if (imu.gaps > 0) warn(std::format("{} gaps in the IMU data, the longest {:.3f} s", imu.gaps, imu.longest_gap_s));
  if (lidar.gaps > 0) warn(std::format("{} gaps between scans, the longest {:.2f} s", lidar.gaps, lidar.longest_gap_s));
  if (imu.not_ascending > 0)
    warn(std::format("{} IMU stamps do not ascend; those samples are dropped", imu.not_ascending));
  if (lidar.not_ascending > 0)
    warn(std::format("{} scan stamps do not ascend; those scans are dropped", lidar.not_ascending));
  if (std::abs(imu.delay_median_s - lidar.delay_median_s) > 0.5)
    warn(
        std::format("IMU stamps lie {:.2f} s and LiDAR stamps {:.2f} s before the recorder's clock: check that both "
                    "sensors share one clock",
                    imu.delay_median_s, lidar.delay_median_s));
}

}  // namespace pllit
