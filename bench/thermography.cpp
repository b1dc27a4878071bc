// The thermographic stage on a recording with given poses: bench_thermography F.bag POSES.tum CONFIG [PREFIX]
// prints the findings and the time of an image; PREFIX.map.ply and PREFIX.anomalies.ply are written where one is given.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <deque>
#include <format>

#include "pllit/base/distribution.hpp"
#include "pllit/io/bag_reader.hpp"
#include "pllit/io/ply.hpp"
#include "pllit/io/tum.hpp"
#include "pllit/slam/config_presets.hpp"
#include "pllit/slam/thermography.hpp"

namespace pllit {
namespace {

constexpr Duration kMaxGap = std::chrono::milliseconds(250);

/// Each point at the pose of its own time.
std::vector<Vector3f> in_world(const LidarScan& scan, const Trajectory& poses, const Rig& rig) {
  std::vector<Vector3f> points_W;
  std::optional<SE3> T_W_L;
  Time posed{};
  for (std::size_t i = 0; i < scan.points_L.size(); ++i) {
    const double range_m = static_cast<double>(scan.points_L[i].norm());
    if (range_m < rig.lidar.min_range_m || range_m > rig.lidar.max_range_m) continue;
    const Time time = scan.start + scan.offsets[i] + rig.lidar_delay;
    if (!T_W_L || time - posed > std::chrono::microseconds(500)) {
      const auto T_W_I = pose_at(poses, time, kMaxGap);
      if (!T_W_I) continue;
      T_W_L = *T_W_I * rig.T_I_L;
      posed = time;
    }
    points_W.push_back(T_W_L->act(scan.points_L[i].cast<double>()).cast<float>());
  }
  return points_W;
}

class Replay {
 public:
  Replay(const Config& config, const Rig& rig, Trajectory poses)
      : config_(config),
        rig_(rig),
        poses_(std::move(poses)),
        planes_(config.map),
        stage_(*rig.camera, config.thermography) {}

  void take(const SensorEvent& event) {
    if (const auto* scan = std::get_if<LidarScan>(&event.data)) scan_ = in_world(*scan, poses_, rig_);
    const auto* image = std::get_if<CameraFrame>(&event.data);
    if (!image) return;
    const Time time = image->time + rig_.camera_delay;
    const auto T_W_I = pose_at(poses_, time, kMaxGap);
    if (!T_W_I) return;
    if (!start_) start_ = time;
    insert_planes(T_W_I->translation());
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t core_begin = std::clock();
    const ThermographyFrame frame = stage_.process({.time = time,
                                                    .T_W_C = *T_W_I * rig_.T_I_C,
                                                    .raw = image->counts,
                                                    .points_W = std::exchange(scan_, {}),
                                                    .planes = &planes_});
    ms_.add(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    core_ms_.add(1e3 * static_cast<double>(std::clock() - core_begin) / CLOCKS_PER_SEC);
    tell(frame, time);
  }

  void summarise(const std::string& prefix) const {
    std::printf("%ld images, %.2f ms each (p99 %.2f), %.2f core-ms (p99 %.2f); map %zu voxels, %.1f MB\n",
                static_cast<long>(ms_.count()), ms_.mean(), ms_.percentile(0.99), core_ms_.mean(),
                core_ms_.percentile(0.99), stage_.map().size(), static_cast<double>(stage_.map().bytes()) / 1e6);
    std::printf("used: mapped %d, learned %d, untrusted %d, frozen %d, contradicts %d, of another depth %d\n", uses_[0],
                uses_[1], uses_[2], uses_[3], uses_[4], uses_[5]);
    for (const Anomaly& a : stage_.anomalies())
      std::printf("%s\n", std::format("{} {} {}: at {:.3f} {:.3f} {:.3f} extent {:.2f} {:.2f} {:.2f} m, change {:.1f} "
                                      "(peak {:.1f}) = {:.1f} sigma, {} voxels, {} views, seen {:.2f} to {:.2f} s, "
                                      "confirmed {:.2f} s, confidence {:.2f}",
                                      a.id, name_of(a.kind), name_of(a.state), a.position_W.x(), a.position_W.y(),
                                      a.position_W.z(), a.extent_m.x(), a.extent_m.y(), a.extent_m.z(), a.mean_change,
                                      a.peak_change, a.mean_sigmas, a.voxels, a.views, since(a.first_seen),
                                      since(a.last_seen), a.confirmed ? since(*a.confirmed) : -1.0, a.confidence)
                              .c_str());
    if (prefix.empty()) return;
    (void)write_ply(prefix + ".map.ply", stage_.map().table());
    (void)write_ply(prefix + ".anomalies.ply", stage_.anomaly_points());
  }

 private:
  double since(Time time) const { return to_seconds(time - poses_.front().time); }

  /// As the odometry does: a scan spread evenly, in the map that normals come from.
  void insert_planes(const Vector3d& p_W) {
    PointCloud cloud;
    for (const Vector3f& point_W : scan_) {
      cloud.points_I.push_back(point_W);
      cloud.intensity.push_back(0.0F);
    }
    planes_.insert(downsample(cloud, config_.scan.insert_voxels * config_.map.voxel_m), SE3::Identity());
    planes_.slide(p_W);
  }

  void tell(const ThermographyFrame& frame, Time time) {
    ++uses_[static_cast<std::size_t>(frame.use)];
    for (const std::uint32_t id : frame.confirmed) std::printf("%8.2f s: alarm %u\n", since(time), id);
    if (ms_.count() % 50 == 0)
      std::printf("%8.2f s: %d observations, %d of %d pairs, rms %.1f, gain %.2f bias %.1f, map %zu, watched %zu\n",
                  since(time), frame.observations, frame.anchor.inliers, frame.anchor.pairs, frame.anchor.rms,
                  frame.anchor.curve.gain, frame.anchor.curve.bias, stage_.map().size(), stage_.watched());
  }

  Config config_;
  Rig rig_;
  Trajectory poses_;
  PlaneMap planes_;
  Thermography stage_;
  std::vector<Vector3f> scan_;
  std::optional<Time> start_;
  Distribution ms_, core_ms_;
  std::array<int, 6> uses_{};
};

int run(const std::string& bag, const std::string& tum, const std::string& preset, const std::string& prefix) {
  const auto config = find_config(preset);
  auto poses = read_tum(tum);
  if (!config || !poses) {
    std::fprintf(stderr, "%s\n", (!config ? config.error() : poses.error()).message.c_str());
    return 2;
  }
  auto source = open_bags({bag}, {.imu_topic = config->input.imu_topic,
                                  .lidar_topic = config->input.lidar_topic,
                                  .image_topic = config->input.image_topic,
                                  .point_time_unit = TimeUnit::nanoseconds});
  if (!source) {
    std::fprintf(stderr, "%s\n", source.error().message.c_str());
    return 2;
  }
  Replay replay(*config, make_rig(config->rig), std::move(*poses));
  for (auto event = (*source)->next(); event && *event; event = (*source)->next()) replay.take(**event);
  replay.summarise(prefix);
  return 0;
}

}  // namespace
}  // namespace pllit

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: bench_thermography F.bag POSES.tum CONFIG [PREFIX]\n");
    return 2;
  }
  return pllit::run(argv[1], argv[2], argv[3], argc > 4 ? argv[4] : "");
}
