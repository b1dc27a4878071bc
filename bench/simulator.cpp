// How fast the simulator is, and how much memory a long drive takes: bench_simulator [SECONDS [KILOMETRES]].
// For each rig SECONDS (default 20) are simulated and thrown away, with LiDAR and IMU alone and with 10 images a second
// too; given are simulated seconds a second of wall time and of processor time, the first second of each left out. Then
// the world of a drive of KILOMETRES (default 7) is made along it, with one scan every 100 m instead of every 1 m.
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <format>
#include <string>

#include "pllit/sim/motion/continuation.hpp"
#include "pllit/sim/places/make_place.hpp"
#include "pllit/sim/simulation.hpp"
#include "pllit/sim/world/ray_lidar.hpp"

namespace {

using namespace pllit;

double wall_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

rusage used() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage;
}

double processor_s() {
  const rusage usage = used();
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double peak_mb() { return static_cast<double>(used().ru_maxrss) / 1e3; }

/// What the simulation of an address costs after its first second.
void report_speed(const char* what, const std::string& address) {
  auto simulation = open_simulation(address);
  if (!simulation) return static_cast<void>(std::fprintf(stderr, "%s\n", simulation.error().message.c_str()));
  const Time warm = simulation->motion().start() + std::chrono::seconds(1);
  Time last = warm;
  double wall_begin_s = 0.0, processor_begin_s = 0.0;
  for (auto event = simulation->next(); event && *event; event = simulation->next()) {
    if ((*event)->received < warm) continue;
    if (wall_begin_s == 0.0) {
      wall_begin_s = wall_s();
      processor_begin_s = processor_s();
    }
    last = (*event)->received;
  }
  const double simulated_s = to_seconds(last - warm);
  std::printf("%-44s %10.2f %14.2f\n", what, simulated_s / (wall_s() - wall_begin_s),
              simulated_s / (processor_s() - processor_begin_s));
}

void report_speeds(double seconds) {
  std::printf("%-44s %10s %14s\n", "simulated seconds in one", "of wall", "of processor");
  struct Line {
    const char *what, *address;
  };
  for (const auto& [what, address] : {
           Line{"XT-32 and IMU, corridor", "sim:corridor?rig=hilti2022&images=none"},
           Line{"XT-32 and IMU, room", "sim:room?rig=hilti2022&images=none"},
           Line{"XT-32, IMU and visible 720x540, corridor", "sim:corridor?rig=hilti2022&light=night"},
           Line{"Mid-360 and IMU, plant", "sim:plant?rig=inspection&images=none"},
           Line{"Mid-360, IMU and thermal 640x512, room", "sim:room?rig=inspection"},
           Line{"Mid-360, IMU and thermal 640x512, plant", "sim:plant?rig=inspection"},
           Line{"Horizon and IMU, street", "sim:street?rig=ntu4dradlm&images=none"},
           Line{"Horizon, IMU and thermal 640x480, street", "sim:street?rig=ntu4dradlm&cars=6&people=8"},
       })
    report_speed(what, std::format("{}&seed=1&duration={}", address, seconds));
}

void report_memory(double kilometres) {
  constexpr double speed_mps = 10.0, reach_m = 150.0;
  const Trajectory drive = street_drive({.seed = 1, .length_m = 1000.0 * kilometres, .speed_mps = speed_mps});
  const double seconds = to_seconds(drive.back().time - drive.front().time);
  const auto place = make_place({.kind = PlaceKind::street,
                                 .path_W = positions_of(drive),
                                 .duration_s = seconds,
                                 .height_m = 1.7,
                                 .clearance_m = 2.5});
  if (!place) return static_cast<void>(std::fprintf(stderr, "%s\n", place.error().message.c_str()));
  RayCaster caster(**place, reach_m);
  Arena arena(0);
  std::printf("\n%10s %10s %10s %10s\n", "metres", "points", "peak MB", "wall s");
  const double begin_s = wall_s();
  double metres = 0.0, next_move_m = 0.0, next_scan_m = 0.0;
  for (std::size_t i = 1; i < drive.size(); ++i) {
    metres += (drive[i].T_W_I.translation() - drive[i - 1].T_W_I.translation()).norm();
    if (metres >= next_move_m) {
      caster.move_to(drive[i].T_W_I.translation(), to_seconds(drive[i].time - drive.front().time));
      next_move_m += 10.0;
    }
    if (metres < next_scan_m) continue;
    const auto here = [T_W_L = drive[i].T_W_I](Time) { return T_W_L; };
    const LidarRun run{.place = **place, .caster = caster, .T_W_L = here, .start = drive.front().time, .seed = 1};
    const auto points = simulate_scan(livox_horizon(), run, 0, arena).points_L.size();
    if (next_scan_m == 1000.0 * std::floor(next_scan_m / 1000.0))
      std::printf("%10.0f %10zu %10.0f %10.1f\n", metres, points, peak_mb(), wall_s() - begin_s);
    next_scan_m += 100.0;
  }
}

}  // namespace

int main(int argc, char** argv) {
  const double kilometres = argc > 2 ? std::atof(argv[2]) : 7.0;
  if (kilometres > 0.0) report_memory(kilometres);  // first: the peak is the process's
  report_speeds(argc > 1 ? std::atof(argv[1]) : 20.0);
}
