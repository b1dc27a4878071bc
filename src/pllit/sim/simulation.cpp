#include "pllit/sim/simulation.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <variant>

namespace pllit {
namespace {

constexpr Duration kTimeBack = std::chrono::seconds(1);

/// A hand-held rig with a LiDAR over the IMU. The noise densities, 0.014 deg/s/sqrt(Hz) and 190 ug/sqrt(Hz), are of the
/// order that makers of small MEMS IMUs state; the walks and ranges are assumed.
Rig handheld_rig() {
  Rig rig;
  rig.T_I_L = pose_from(exp_so3({0.01, -0.02, 0.5}), {0.04, -0.02, 0.11});
  rig.lidar = {.min_range_m = 0.5, .max_range_m = 120.0, .range_sigma_m = 0.01, .beam_sigma_rad = 0.0005};
  rig.imu = {.gyro_density = 0.00024,
             .accel_density = 0.0019,
             .gyro_bias_walk = 1e-5,
             .accel_bias_walk = 1e-4,
             .gyro_bias_sigma = 0.01,
             .accel_bias_sigma = 0.05};
  return rig;
}

ImuNoise no_noise() {
  return {.gyro_density = 0.0,
          .accel_density = 0.0,
          .gyro_bias_walk = 0.0,
          .accel_bias_walk = 0.0,
          .gyro_bias_sigma = 0.0,
          .accel_bias_sigma = 0.0};
}

Scene make_scene(const SimConfig& config) {
  if (config.scene == SimConfig::Place::corridor) return corridor(1.5 * config.speed_mps * config.duration_s);
  return config.scene == SimConfig::Place::room ? room(config.seed) : outdoor(config.seed);
}

Motion make_motion(const SimConfig& config, const Lane& lane) {
  const MotionConfig motion{.seed = config.seed, .duration_s = config.duration_s, .speed_mps = config.speed_mps};
  return config.motion == SimConfig::Carried::walk ? walk_along(lane, motion) : fast_shake(lane, motion);
}

SpinningLidar make_lidar(const SimConfig& config, const Rig& rig) {
  SpinningLidar lidar{.pattern = config.lidar == SimConfig::Lidar::ring32 ? ring32_pattern() : ring16_pattern(),
                      .model = rig.lidar,
                      .T_I_L = rig.T_I_L};
  if (config.ideal) lidar.model.range_sigma_m = lidar.model.beam_sigma_rad = 0.0;
  return lidar;
}

/// The event with its sensor's stamp moved.
SensorEvent restamped(SensorEvent event, Duration by) {
  if (auto* sample = std::get_if<ImuSample>(&event.data)) sample->time += by;
  if (auto* scan = std::get_if<LidarScan>(&event.data)) scan->start += by;
  return event;
}

}  // namespace

Simulation::Simulation(const SimConfig& config)
    : config_(config),
      rig_(handheld_rig()),
      scene_(make_scene(config)),
      motion_(make_motion(config, scene_.lane)),
      end_(motion_.start() + from_seconds(config.duration_s)),
      lidar_(make_lidar(config, rig_)),
      imu_(fresh_imu()),
      delivered_until_(motion_.start()) {}

ImuStream Simulation::fresh_imu() const {
  return ImuStream(motion_.start(), config_.imu_rate_hz, config_.ideal ? no_noise() : rig_.imu, config_.seed);
}

Time Simulation::next_scan_end() const { return motion_.start() + (scan_index_ + 1) * lidar_.pattern.period; }
Time Simulation::next_made_time() const { return std::min(imu_.next_time(), next_scan_end()); }
bool Simulation::finished() const { return next_made_time() > end_; }

Expected<std::optional<SensorEvent>> Simulation::next() {
  // No event is received before its true time, so the first pending one is due once all up to its time have been made.
  while (!finished() && (pending_.empty() || pending_.front().received >= next_made_time())) make_next();
  if (pending_.empty()) return std::nullopt;
  SensorEvent event = std::move(pending_.front());
  pending_.pop_front();
  delivered_until_ = event.received;
  return event;
}

double Simulation::progress() const {
  const double share = to_seconds(delivered_until_ - motion_.start()) / to_seconds(end_ - motion_.start());
  return std::min(share, 1.0);
}

void Simulation::make_next() {
  if (imu_.next_time() <= next_scan_end())
    make_imu_sample();
  else
    make_scan();
}

void Simulation::make_imu_sample() {
  const double t_s = to_seconds(imu_.next_time() - motion_.start());
  ImuSample sample = imu_.next(motion_);
  Time received = sample.time;
  const bool first_of_pair = imu_index_++ % 2 == 0;
  if (config_.faults.imu_gap.contains(t_s)) return;
  if (config_.accel_in_g) sample.accel_mps2 /= kStandardGravity_mps2;
  if (config_.faults.imu_nan.contains(t_s))
    sample.gyro_rps = sample.accel_mps2 = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  if (config_.faults.swapped_imu.contains(t_s) && first_of_pair) received = imu_.next_time() + Duration(1);
  deliver({received, sample}, t_s);
}

void Simulation::make_scan() {
  const Time end = next_scan_end();
  const double t_s = to_seconds(end - motion_.start());
  const auto index = static_cast<std::uint64_t>(scan_index_++);
  if (config_.faults.lidar_gap.contains(t_s)) return;
  // A stream a scan: a lost scan changes nothing in the others.
  const Random random(config_.seed, 1000 + index);
  LidarScan scan = simulate_scan(lidar_, scene_.world, motion_, end - lidar_.pattern.period, random);
  const bool late = config_.faults.late_scans.contains(t_s);
  deliver({late ? end + from_seconds(config_.faults.late_by_s) : end, std::move(scan)}, t_s);
}

void Simulation::deliver(SensorEvent event, double t_s) {
  if (config_.faults.time_back.contains(t_s)) event = restamped(std::move(event), -kTimeBack);
  const int copies = config_.faults.duplicates.contains(t_s) ? 2 : 1;
  const auto order = [](const SensorEvent& e) { return std::pair(e.received, e.data.index()); };  // IMU before scan
  const auto after = std::ranges::upper_bound(pending_, order(event), {}, order);
  pending_.insert(after, static_cast<std::size_t>(copies), event);
}

Trajectory Simulation::truth() const {
  Trajectory truth;
  for (ImuStream imu = fresh_imu(); imu.next_time() <= end_; imu.next(motion_))
    truth.push_back({imu.next_time(), motion_.at(imu.next_time()).T_W_I});
  return truth;
}

std::vector<StampedImuBias> Simulation::true_biases() const {
  std::vector<StampedImuBias> biases;
  for (ImuStream imu = fresh_imu(); imu.next_time() <= end_; imu.next(motion_))
    biases.push_back({imu.next_time(), imu.bias()});
  return biases;
}

Expected<Simulation> open_simulation(std::string_view source) {
  return parse_sim_config(source).transform([](const SimConfig& config) { return Simulation(config); });
}

}  // namespace pllit
