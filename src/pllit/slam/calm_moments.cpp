#include "pllit/slam/calm_moments.hpp"

#include <algorithm>
#include <cmath>

namespace pllit {
namespace {

std::optional<CalmMoment> calmer(const std::optional<CalmMoment>& a, const std::optional<CalmMoment>& b) {
  if (!a || !b) return a ? a : b;
  return a->turn_rps <= b->turn_rps ? a : b;
}

/// The scan's points in C as from the attitude at `time`, the rig turning evenly. Its shift within a scan stays.
std::vector<Vector3f> turned_to(const LidarScan& scan, Time time, const Eigen::Vector3d& gyro_rps, const Rig& rig) {
  const SE3 T_C_I = rig.T_I_C.inverse();
  std::vector<Vector3f> points_C;
  for (std::size_t i = 0; i < scan.points_L.size(); ++i) {
    const double range_m = static_cast<double>(scan.points_L[i].norm());
    if (range_m < rig.lidar.min_range_m || range_m > rig.lidar.max_range_m) continue;
    const double since_s = to_seconds(scan.start + scan.offsets[i] + rig.lidar_delay - time);
    const Vector3d p_I = exp_so3(since_s * gyro_rps).act(rig.T_I_L.act(scan.points_L[i].cast<double>()));
    points_C.push_back(T_C_I.act(p_I).cast<float>());
  }
  return points_C;
}

}  // namespace

void CalmMoments::add(const SensorEvent& event) {
  if (const auto* imu = std::get_if<ImuSample>(&event.data)) {
    if (!imu->gyro_rps.allFinite()) return;
    turns_.push_back({imu->time, imu->gyro_rps});
    while (to_seconds(imu->time - turns_.front().time) > 1.0) turns_.pop_front();
  } else if (const auto* image = std::get_if<CameraFrame>(&event.data)) {
    constexpr std::size_t most_open = 30;  // a second or so: where scans come late or not at all
    open_.push_back(*image);
    if (open_.size() > most_open) open_.pop_front();
  } else if (const auto* scan = std::get_if<LidarScan>(&event.data)) {
    match(*scan);
  }
}

/// Images taken during a scan, or just before, are candidates for the moments.
void CalmMoments::match(const LidarScan& scan) {
  constexpr Duration slack = std::chrono::milliseconds(25);  // images are often triggered between two scans
  const Time start = scan.start + rig_.lidar_delay, end = scan.end() + rig_.lidar_delay;
  while (!open_.empty() && open_.front().time + rig_.camera_delay <= end) {
    const CameraFrame image = open_.front();
    open_.pop_front();
    const Time time = image.time + rig_.camera_delay;
    const auto turn = turn_at(time);
    if (time < start - slack || !turn) continue;
    auto& best = kept_[span_of(time)];
    const double turn_rps = turn->gyro_rps.norm();
    if (best && best->turn_rps <= turn_rps) continue;
    best = CalmMoment{.time = time,
                      .counts = image.counts,
                      .turn_rps = turn_rps,
                      .points_C = turned_to(scan, time, turn->gyro_rps, rig_)};
  }
}

/// The mean rate around a time; nothing where the IMU is silent.
std::optional<CalmMoments::Turn> CalmMoments::turn_at(Time time) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const Turn& turn : turns_) {
    if (std::abs(to_seconds(turn.time - time)) > 0.05) continue;
    sum += turn.gyro_rps;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return Turn{time, sum / count};
}

/// The span that a time lies in, made room for.
std::size_t CalmMoments::span_of(Time time) {
  if (!start_) start_ = time;
  const auto span = [&] { return static_cast<std::size_t>(std::max(0.0, to_seconds(time - *start_)) / span_s_); };
  while (span() >= most_) {
    kept_.resize(kept_.size() + kept_.size() % 2);
    for (std::size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = calmer(kept_[2 * i], kept_[2 * i + 1]);
    kept_.resize(kept_.size() / 2);
    span_s_ *= 2.0;
  }
  if (span() >= kept_.size()) kept_.resize(span() + 1);
  return span();
}

std::vector<CalmMoment> CalmMoments::moments() const {
  std::vector<CalmMoment> moments;
  for (const auto& moment : kept_)
    if (moment) moments.push_back(*moment);
  return moments;
}

}  // namespace pllit
