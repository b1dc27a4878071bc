// Time of each LiDAR stage on one simulated scan of 64 000 rays in a room (Google Benchmark).
#include <benchmark/benchmark.h>

#include "pllit/sim/simulation.hpp"
#include "pllit/slam/odometry.hpp"

namespace pllit {
namespace {

/// A scan in the middle of a walk, the motion that belongs to it and a map of what came before.
struct Scene {
  Rig rig;
  Config config;
  PlaneMap map{PlaneMapConfig{}};
  LidarScan scan;
  Propagation motion;
  PointCloud cloud, dense, sparse;
};

Scene make_scene() {
  auto simulation = open_simulation("sim:box_room?seed=1&duration=10");
  Scene scene;
  scene.rig = simulation->rig();
  PacketAssembler assembler(scene.rig);
  while (const auto event = simulation->next().value()) {
    if (const auto* imu = std::get_if<ImuSample>(&event->data)) assembler.push(*imu);
    if (const auto* scan = std::get_if<LidarScan>(&event->data)) assembler.push(*scan);
    while (const auto packet = assembler.pop()) {
      if (!scene.cloud.points_I.empty()) scene.map.insert(scene.dense, scene.motion.predicted.mean.T_W_I());
      Estimate start;  // the truth: benchmarks need no estimate
      const MotionState truth = simulation->motion().at(packet->scan->start);
      start.mean.time = packet->scan->start;
      const SO3 R_W_I = truth.T_W_I.asSO3();
      start.mean.R_W_I = R_W_I;
      start.mean.p_W = truth.T_W_I.translation();
      start.mean.v_W = truth.v_W;
      start.covariance = 1e-4 * Matrix18::Identity();
      scene.scan = *packet->scan;
      scene.motion = propagate(start, packet->imu, packet->end, scene.rig.imu);
      scene.cloud = deskew(scene.scan, scene.motion.path, scene.rig.T_I_L, scene.rig.lidar);
      scene.dense = downsample(scene.cloud, scene.config.scan.insert_voxels * scene.config.map.voxel_m);
      scene.sparse = downsample(scene.dense, scene.config.scan.match_voxels * scene.config.map.voxel_m);
    }
  }
  return scene;
}

void deskewing(benchmark::State& state) {
  const Scene scene = make_scene();
  for (auto _ : state)
    benchmark::DoNotOptimize(deskew(scene.scan, scene.motion.path, scene.rig.T_I_L, scene.rig.lidar));
  state.counters["points"] = static_cast<double>(scene.scan.points_L.size());
}

void downsampling(benchmark::State& state) {
  const Scene scene = make_scene();
  for (auto _ : state) benchmark::DoNotOptimize(downsample(scene.cloud, 0.2));
}

void plane_fit(benchmark::State& state) {
  const Scene scene = make_scene();
  const SE3 T_W_I = scene.motion.predicted.mean.T_W_I();
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(scene.map.plane_at(T_W_I.act(scene.sparse.points_I[i].cast<double>())));
    i = (i + 1) % scene.sparse.points_I.size();
  }
}

void matching(benchmark::State& state) {
  const Scene scene = make_scene();
  Arena arena(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    PlaneResiduals residuals(scene.sparse, scene.map, scene.rig, Matrix6(1e-4 * Matrix6::Identity()),
                             scene.config.planes, arena);
    benchmark::DoNotOptimize(iterated_update(
        scene.motion.predicted, [&](const NavState& x) { return residuals(x).sums; }, scene.config.filter));
  }
  state.counters["points"] = static_cast<double>(scene.sparse.points_I.size());
}

void map_insertion(benchmark::State& state) {
  Scene scene = make_scene();
  const SE3 T_W_I = scene.motion.predicted.mean.T_W_I();
  for (auto _ : state) scene.map.insert(scene.dense, T_W_I);
  state.counters["points"] = static_cast<double>(scene.dense.points_I.size());
}

BENCHMARK(deskewing)->Unit(benchmark::kMillisecond);
BENCHMARK(downsampling)->Unit(benchmark::kMillisecond);
BENCHMARK(plane_fit)->Unit(benchmark::kMicrosecond);
BENCHMARK(matching)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(map_insertion)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pllit
