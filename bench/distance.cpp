// Time a frame and memory against the distance covered: bench_distance [SIM_ADDRESS], one row every 100 m.
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "pllit/sim/simulation.hpp"
#include "pllit/slam/run.hpp"

namespace {

double resident_mb() {
  long pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return static_cast<double>(resident * sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace pllit;
  const std::string address = argc > 1 ? argv[1] : "sim:box_corridor?duration=340&speed=3&lidar=ring16";
  auto simulation = open_simulation(address);
  if (!simulation) {
    std::fprintf(stderr, "%s\n", simulation.error().message.c_str());
    return 2;
  }
  std::printf("%10s %10s %12s %12s\n", "metres", "frames", "ms a frame", "resident MB");
  RunSummary summary;
  double next_m = 100.0, sum_ms = 0.0;
  int frames = 0;
  const auto report = [&](const FrameEstimate& frame) -> Expected<void> {
    for (std::size_t i = 1; i < stage_names.size(); ++i)
      sum_ms += frame.stage_ms[i];  // without reading: that is the simulator
    ++frames;
    if (summary.length_m < next_m) return {};
    std::printf("%10.0f %10d %12.2f %12.1f\n", summary.length_m, summary.frames, sum_ms / frames, resident_mb());
    next_m += 100.0;
    sum_ms = 0.0;
    frames = 0;
    return {};
  };
  const Rig rig = simulation->rig();
  const auto done = run_odometry(*simulation, rig, {}, {.sink = report}, summary);
  if (!done) std::fprintf(stderr, "%s\n", done.error().message.c_str());
  return done ? 0 : 1;
}
