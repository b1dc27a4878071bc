#include "pllit/sim/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

namespace pllit {
namespace {

std::vector<SensorEvent> all_events(Simulation& simulation) {
  std::vector<SensorEvent> events;
  while (true) {
    auto event = simulation.next();
    EXPECT_TRUE(event.has_value());
    if (!event || !*event) return events;
    events.push_back(std::move(**event));
  }
}

/// What sim:box_room?lidar=ring16&duration=6 with more options (&key=value) delivers.
std::vector<SensorEvent> events_of(const std::string& options) {
  auto simulation = open_simulation("sim:box_room?lidar=ring16&duration=6" + options);
  EXPECT_TRUE(simulation) << simulation.error().message;
  return all_events(*simulation);
}

template <class Data>
std::vector<Data> only(const std::vector<SensorEvent>& events) {
  std::vector<Data> data;
  for (const SensorEvent& event : events)
    if (const auto* found = std::get_if<Data>(&event.data)) data.push_back(*found);
  return data;
}

void append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

std::string bytes_of(const std::vector<SensorEvent>& events) {
  std::string bytes;
  for (const SensorEvent& event : events) {
    append(bytes, &event.received, sizeof event.received);
    if (const auto* imu = std::get_if<ImuSample>(&event.data)) {
      append(bytes, &imu->time, sizeof imu->time);
      append(bytes, imu->gyro_rps.data(), 3 * sizeof(double));
      append(bytes, imu->accel_mps2.data(), 3 * sizeof(double));
    } else if (const auto* scan = std::get_if<LidarScan>(&event.data)) {
      append(bytes, &scan->start, sizeof scan->start);
      for (std::size_t i = 0; i < scan->points_L.size(); ++i) {
        append(bytes, scan->points_L[i].data(), 3 * sizeof(float));
        append(bytes, &scan->offsets[i], sizeof(Duration));
        append(bytes, &scan->intensity[i], sizeof(float));
      }
    }
  }
  return bytes;
}

double since_start_s(Time time) { return to_seconds(time - Time(std::chrono::seconds(1'700'000'000))); }

TEST(Simulation, DeliversBothSensorsInOrderReceivedWithNothingMissing) {
  const auto events = events_of("&seed=3");
  EXPECT_TRUE(std::ranges::is_sorted(events, {}, &SensorEvent::received));
  EXPECT_EQ(only<ImuSample>(events).size(), 1201u);
  const auto scans = only<LidarScan>(events);
  ASSERT_EQ(scans.size(), 60u);
  for (std::size_t i = 0; i < scans.size(); ++i)
    EXPECT_NEAR(since_start_s(scans[i].start), 0.1 * static_cast<double>(i), 1e-9);
}

TEST(Simulation, DeliversAScanAfterTheImuSampleAtItsEnd) {
  const auto events = events_of("&seed=3");
  Time latest_imu{};
  for (const SensorEvent& event : events) {
    if (const auto* imu = std::get_if<ImuSample>(&event.data)) latest_imu = imu->time;
    if (const auto* scan = std::get_if<LidarScan>(&event.data)) {
      EXPECT_EQ(event.received, scan->start + std::chrono::milliseconds(100));
      EXPECT_EQ(latest_imu, event.received);
    }
  }
}

TEST(Simulation, GivesTheSameBytesForTheSameSeedAndOthersForAnother) {
  const auto bytes = [](const std::string& options) {
    auto simulation = open_simulation("sim:box_room?lidar=ring16&duration=3" + options);
    EXPECT_TRUE(simulation);
    return bytes_of(all_events(*simulation));
  };
  for (const std::string options : {"", "&ideal=1", "&motion=shake"}) {
    const std::string first = bytes(options + "&seed=3");
    EXPECT_TRUE(first == bytes(options + "&seed=3"));  // too long to print
    EXPECT_TRUE(first != bytes(options + "&seed=4"));
  }
}

TEST(Simulation, MayBeMovedWhileItRuns) {
  auto first = open_simulation("sim:box_room?lidar=ring16&duration=3");
  ASSERT_TRUE(first);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(first->next());
  Simulation second = std::move(*first);
  EXPECT_EQ(all_events(second).size() + 100u, 601u + 30u);
}

TEST(Simulation, RunsInEverySceneWithEveryMotion) {
  for (const std::string scene : {"room", "corridor", "street"}) {
    for (const std::string motion : {"walk", "shake"}) {
      auto simulation = open_simulation("sim:box_" + scene + "?lidar=ring16&duration=3&motion=" + motion);
      ASSERT_TRUE(simulation);
      EXPECT_EQ(simulation->progress(), 0.0);
      const auto scans = only<LidarScan>(all_events(*simulation));
      EXPECT_EQ(simulation->progress(), 1.0);
      ASSERT_EQ(scans.size(), 30u);
      for (const LidarScan& scan : scans) EXPECT_GT(scan.points_L.size(), 5000u) << scene;
    }
  }
}

TEST(Simulation, KnowsItsTruthAtEveryImuSample) {
  const auto simulation = open_simulation("sim:box_room?duration=6&imu_rate=100&lidar=ring16");
  ASSERT_TRUE(simulation);
  const Trajectory truth = simulation->truth();
  ASSERT_EQ(truth.size(), 601u);
  for (const StampedPose& pose : truth)
    ASSERT_EQ(pose.T_W_I.coeffs(), simulation->motion().at(pose.time).T_W_I.coeffs());
  EXPECT_GT(path_length_m(truth), 1.0);
}

TEST(Simulation, KnowsItsTrueBiases) {
  auto simulation = open_simulation("sim:box_room?duration=10&lidar=ring16");
  ASSERT_TRUE(simulation);
  const auto biases = simulation->true_biases();
  const Motion motion = simulation->motion();
  Vector3d gyro_sum = Vector3d::Zero(), accel_sum = Vector3d::Zero();
  const auto samples = only<ImuSample>(all_events(*simulation));
  ASSERT_EQ(samples.size(), biases.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    ASSERT_EQ(samples[i].time, biases[i].time);
    const ImuSample exact = exact_imu(motion.at(samples[i].time), samples[i].time);
    gyro_sum += samples[i].gyro_rps - exact.gyro_rps - biases[i].bias.gyro_rps;
    accel_sum += samples[i].accel_mps2 - exact.accel_mps2 - biases[i].bias.accel_mps2;
  }
  // White noise alone remains: its mean over 10 s has the deviation density / sqrt(10 s).
  EXPECT_LT((gyro_sum / static_cast<double>(samples.size())).norm(), 4.0 * std::sqrt(3.0) * 0.00024 / std::sqrt(10.0));
  EXPECT_LT((accel_sum / static_cast<double>(samples.size())).norm(), 4.0 * std::sqrt(3.0) * 0.0019 / std::sqrt(10.0));
  EXPECT_GT(biases.front().bias.gyro_rps.norm(), 1e-4);
  EXPECT_NE(biases.front().bias.gyro_rps, biases.back().bias.gyro_rps);
}

TEST(Simulation, HasNeitherNoiseNorBiasWhenIdeal) {
  auto simulation = open_simulation("sim:box_room?duration=6&lidar=ring16&ideal=1");
  ASSERT_TRUE(simulation);
  for (const StampedImuBias& bias : simulation->true_biases()) ASSERT_EQ(bias.bias.gyro_rps, Vector3d::Zero());
  const auto events = all_events(*simulation);
  for (const ImuSample& sample : only<ImuSample>(events)) {
    const ImuSample exact = exact_imu(simulation->motion().at(sample.time), sample.time);
    ASSERT_EQ(sample.gyro_rps, exact.gyro_rps);
    ASSERT_EQ(sample.accel_mps2, exact.accel_mps2);
  }
  for (const LidarScan& scan : only<LidarScan>(events)) {
    for (std::size_t i = 0; i < scan.points_L.size(); i += 50) {
      const SE3 T_W_L = simulation->motion().at(scan.start + scan.offsets[i]).T_W_I * simulation->rig().T_I_L;
      ASSERT_LT(simulation->boxes().distance_m(T_W_L.act(scan.points_L[i].cast<double>())), 1e-6);
    }
  }
}

TEST(SimulatedFaults, LoseImuSamplesInTheGapOnly) {
  const auto whole = only<ImuSample>(events_of("")), gapped = only<ImuSample>(events_of("&imu_gap=3:3.5"));
  ASSERT_EQ(gapped.size(), whole.size() - 100);
  std::size_t kept = 0;
  for (const ImuSample& sample : whole) {
    const double t_s = since_start_s(sample.time);
    if (t_s >= 3.0 && t_s < 3.5) continue;
    ASSERT_EQ(gapped[kept].time, sample.time);
    ASSERT_EQ(gapped[kept++].accel_mps2, sample.accel_mps2);
  }
}

TEST(SimulatedFaults, SilenceTheLidarAndLeaveOtherScansAsTheyWere) {
  const auto whole = only<LidarScan>(events_of("")), gapped = only<LidarScan>(events_of("&lidar_gap=2:4"));
  ASSERT_EQ(gapped.size(), whole.size() - 20);
  EXPECT_EQ(gapped[19].start - gapped[18].start, std::chrono::milliseconds(2100));
  EXPECT_EQ(gapped.back().points_L, whole.back().points_L);
}

TEST(SimulatedFaults, SetTheClockBackForAWhile) {
  const auto whole = events_of(""), back = events_of("&time_back=3:4");
  const auto imu = only<ImuSample>(whole), imu_back = only<ImuSample>(back);
  ASSERT_EQ(imu.size(), imu_back.size());
  for (std::size_t i = 0; i < imu.size(); ++i) {
    const double t_s = since_start_s(imu[i].time);
    const bool wrong = t_s >= 3.0 && t_s < 4.0;
    ASSERT_EQ(imu[i].time - imu_back[i].time, wrong ? std::chrono::seconds(1) : std::chrono::seconds(0));
  }
  const auto scans = only<LidarScan>(whole), scans_back = only<LidarScan>(back);
  EXPECT_EQ(scans[35].start - scans_back[35].start, std::chrono::seconds(1));
  EXPECT_EQ(scans[45].start, scans_back[45].start);
  EXPECT_TRUE(std::ranges::is_sorted(back, {}, &SensorEvent::received));
}

TEST(SimulatedFaults, DeliverMessagesTwice) {
  const auto events = events_of("&duplicates=3:3.5");
  const auto imu = only<ImuSample>(events);
  EXPECT_EQ(imu.size(), 1201u + 100u);
  EXPECT_EQ(imu[600].time, imu[601].time);
  EXPECT_EQ(imu[600].accel_mps2, imu[601].accel_mps2);
  EXPECT_EQ(only<LidarScan>(events).size(), 60u + 5u);
}

TEST(SimulatedFaults, PutNanIntoImuSamples) {
  int broken = 0;
  for (const ImuSample& sample : only<ImuSample>(events_of("&imu_nan=3:3.02"))) {
    const double t_s = since_start_s(sample.time);
    EXPECT_EQ(sample.gyro_rps.hasNaN() && sample.accel_mps2.hasNaN(), t_s >= 3.0 && t_s < 3.02);
    broken += sample.gyro_rps.hasNaN();
  }
  EXPECT_EQ(broken, 4);
}

TEST(SimulatedFaults, DeliverScansLateAmongYoungerImuSamples) {
  const auto events = events_of("&late_scans=3:4");
  EXPECT_TRUE(std::ranges::is_sorted(events, {}, &SensorEvent::received));
  int late = 0;
  for (std::size_t i = 1; i < events.size(); ++i) {
    const auto* scan = std::get_if<LidarScan>(&events[i].data);
    if (!scan) continue;
    const Time end = scan->start + std::chrono::milliseconds(100);
    const double t_s = since_start_s(end);
    const bool wanted_late = t_s >= 3.0 && t_s < 4.0;
    EXPECT_EQ(events[i].received - end, wanted_late ? std::chrono::milliseconds(80) : std::chrono::milliseconds(0));
    EXPECT_EQ(std::get<ImuSample>(events[i - 1].data).time, events[i].received);
    late += wanted_late;
  }
  EXPECT_EQ(late, 10);
}

TEST(SimulatedFaults, SwapNeighbouringImuSamples) {
  const auto whole = only<ImuSample>(events_of("")), swapped = only<ImuSample>(events_of("&swapped_imu=3:4"));
  ASSERT_EQ(whole.size(), swapped.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const bool in_interval = i >= 600 && i < 800;
    const std::size_t partner = !in_interval ? i : (i % 2 == 0 ? i + 1 : i - 1);
    ASSERT_EQ(swapped[i].time, whole[partner].time) << i;
  }
}

TEST(SimulatedFaults, ReportAccelerationInG) {
  const auto si = only<ImuSample>(events_of("")), in_g = only<ImuSample>(events_of("&accel_unit=g"));
  ASSERT_EQ(si.size(), in_g.size());
  for (std::size_t i = 0; i < si.size(); ++i) {
    ASSERT_LT((in_g[i].accel_mps2 * 9.80665 - si[i].accel_mps2).norm(), 1e-12);
    ASSERT_EQ(in_g[i].gyro_rps, si[i].gyro_rps);
  }
  EXPECT_NEAR(in_g.front().accel_mps2.norm(), 1.0, 0.05);
}

}  // namespace
}  // namespace pllit
