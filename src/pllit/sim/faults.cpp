#include "pllit/sim/faults.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace pllit {
namespace {

constexpr Duration kTimeBack = std::chrono::seconds(1);

void restamp(SensorEvent& event, Duration by) {
  if (auto* sample = std::get_if<ImuSample>(&event.data)) sample->time += by;
  if (auto* scan = std::get_if<LidarScan>(&event.data)) scan->start += by;
  if (auto* frame = std::get_if<CameraFrame>(&event.data)) frame->time += by;
}

}  // namespace

void FaultyLine::push(SensorEvent event, Time next) {
  const double t_s = to_seconds(event.received - start_);
  const bool imu = std::holds_alternative<ImuSample>(event.data), lidar = std::holds_alternative<LidarScan>(event.data);
  const bool first_of_pair = imu && imu_samples_++ % 2 == 0;
  const FaultInterval& gap = imu ? faults_.imu_gap : lidar ? faults_.lidar_gap : faults_.image_gap;
  if (gap.contains(t_s)) return;
  if (faults_.lost_share > 0.0 && random_.uniform() < faults_.lost_share) return;
  if (!imu && faults_.clock_drift_ppm != 0.0) restamp(event, from_seconds(1e-6 * faults_.clock_drift_ppm * t_s));
  if (imu && faults_.imu_nan.contains(t_s)) {
    auto& sample = std::get<ImuSample>(event.data);
    sample.gyro_rps = sample.accel_mps2 = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  if (faults_.swapped_imu.contains(t_s) && first_of_pair) event.received = next + Duration(1);
  const bool late =
      (lidar && faults_.late_scans.contains(t_s)) || (!imu && !lidar && faults_.late_images.contains(t_s));
  if (late) event.received += from_seconds(faults_.late_by_s);
  deliver(std::move(event), t_s);
}

void FaultyLine::deliver(SensorEvent event, double t_s) {
  if (faults_.time_back.contains(t_s)) restamp(event, -kTimeBack);
  const std::size_t copies = faults_.duplicates.contains(t_s) ? 2 : 1;
  const auto order = [](const SensorEvent& e) { return std::pair(e.received, e.data.index()); };  // IMU, scan, image
  const auto after = std::ranges::upper_bound(pending_, order(event), {}, order);
  pending_.insert(after, copies, event);
}

std::optional<SensorEvent> FaultyLine::pop_before(Time until) {
  if (pending_.empty() || pending_.front().received >= until) return std::nullopt;
  SensorEvent event = std::move(pending_.front());
  pending_.pop_front();
  return event;
}

}  // namespace pllit
