#include "pllit/sensor/packet.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace pllit {
namespace {

using namespace std::chrono_literals;

ImuSample imu_at(Duration t) { return {Time(t), Vector3d::Zero(), Vector3d(0.0, 0.0, 9.81)}; }

LidarScan scan_from(Duration start, Duration length = 100ms) {
  LidarScan scan;
  scan.start = Time(start);
  scan.points_L = {Vector3f(1.0F, 0.0F, 0.0F), Vector3f(0.0F, 1.0F, 0.0F)};
  scan.offsets = {Duration{0}, length};
  scan.intensity = {1.0F, 2.0F};
  return scan;
}

void push_imu(PacketAssembler& assembler, Duration from, Duration to, Duration step = 10ms) {
  for (Duration t = from; t <= to; t += step) assembler.push(imu_at(t));
}

TEST(PacketAssembler, WaitsUntilTheImuCoversTheScan) {
  PacketAssembler assembler{Rig{}};
  push_imu(assembler, 0ms, 190ms);
  assembler.push(scan_from(100ms));
  EXPECT_FALSE(assembler.pop());
  assembler.push(imu_at(200ms));
  const auto packet = assembler.pop();
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->end, Time(200ms));
  EXPECT_TRUE(packet->scan);
  EXPECT_FALSE(assembler.pop());
}

TEST(PacketAssembler, GivesEachPacketTheSamplesAroundBothItsEnds) {
  PacketAssembler assembler{Rig{}};
  push_imu(assembler, 3ms, 403ms);
  assembler.push(scan_from(100ms));
  assembler.push(scan_from(200ms));
  const auto first = assembler.pop(), second = assembler.pop();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->imu.front().time, Time(93ms));  // the last one before the first scan
  EXPECT_EQ(first->imu.back().time, Time(203ms));
  EXPECT_EQ(second->imu.front().time, Time(193ms));
  EXPECT_EQ(second->imu.back().time, Time(303ms));
}

TEST(PacketAssembler, DropsAndCountsWhatCannotBe) {
  PacketAssembler assembler{Rig{}};
  push_imu(assembler, 0ms, 100ms);
  assembler.push(imu_at(100ms));
  assembler.push(imu_at(40ms));
  ImuSample broken = imu_at(110ms);
  broken.gyro_rps.x() = std::nan("");
  assembler.push(broken);
  assembler.push(LidarScan{.start = Time(0ms), .points_L = {}, .offsets = {}, .intensity = {}});
  assembler.push(scan_from(0ms));
  ASSERT_TRUE(assembler.pop());
  assembler.push(scan_from(0ms));
  EXPECT_EQ(assembler.counts().imu_not_ascending, 2);
  EXPECT_EQ(assembler.counts().imu_not_finite, 1);
  EXPECT_EQ(assembler.counts().scans_empty, 1);
  EXPECT_EQ(assembler.counts().scans_too_late, 1);
}

TEST(PacketAssembler, GoesOnWithTheImuAloneWhereTheLidarFallsSilent) {
  PacketAssembler assembler{Rig{}};
  push_imu(assembler, 0ms, 100ms);
  assembler.push(scan_from(0ms));
  ASSERT_TRUE(assembler.pop());
  push_imu(assembler, 110ms, 1000ms);
  Time end = Time(100ms);
  int bridges = 0;
  while (const auto packet = assembler.pop()) {
    EXPECT_FALSE(packet->scan);
    EXPECT_EQ(packet->end - end, 100ms);
    end = packet->end;
    ++bridges;
  }
  EXPECT_GE(bridges, 5);
  assembler.push(scan_from(950ms));
  push_imu(assembler, 1010ms, 1100ms);
  const auto packet = assembler.pop();
  ASSERT_TRUE(packet);
  EXPECT_TRUE(packet->scan);
}

TEST(PacketAssembler, DoesNotWaitForeverForASilentImu) {
  PacketAssembler assembler{Rig{}};
  push_imu(assembler, 0ms, 150ms);
  for (int i = 0; i < 12; ++i) assembler.push(scan_from(i * 100ms));
  int packets = 0;
  while (assembler.pop()) ++packets;
  EXPECT_GE(packets, 5);
  while (assembler.flush()) ++packets;
  EXPECT_EQ(packets, 12);
}

TEST(PacketAssembler, AppliesTheLidarDelay) {
  Rig rig;
  rig.lidar_delay = 25ms;
  PacketAssembler assembler{rig};
  push_imu(assembler, 0ms, 200ms);
  assembler.push(scan_from(0ms));
  EXPECT_EQ(assembler.pop()->end, Time(125ms));
}

CameraFrame image_at(Duration t) { return {Time(t), cv::Mat(2, 2, CV_8UC1)}; }

/// A scan of a point every 10 ms.
LidarScan dense_scan_from(Duration start, Duration length = 100ms) {
  LidarScan scan{.start = Time(start), .points_L = {}, .offsets = {}, .intensity = {}};
  for (Duration t = 10ms; t <= length; t += 10ms) {
    scan.points_L.push_back(Vector3f(1.0F, 0.0F, static_cast<float>((start + t).count()) * 1e-9F));
    scan.offsets.push_back(t);
    scan.intensity.push_back(1.0F);
    scan.rings.push_back(static_cast<std::uint16_t>(t / 10ms));
  }
  return scan;
}

constexpr AssemblerConfig with_images{.images = true};

/// Scans back to back from 0 and IMU data until `until`.
PacketAssembler scanned(Duration until) {
  PacketAssembler assembler{Rig{}, with_images};
  push_imu(assembler, 0ms, until);
  for (Duration t = 0ms; t + 100ms <= until; t += 100ms) assembler.push(dense_scan_from(t));
  return assembler;
}

TEST(PacketAssemblerWithImages, CutsScansAtTheImages) {
  PacketAssembler assembler = scanned(400ms);
  for (const Duration t : {50ms, 150ms, 250ms}) assembler.push(image_at(t));
  for (const Duration end : {50ms, 150ms, 250ms}) {
    const auto packet = assembler.pop();
    ASSERT_TRUE(packet && packet->scan && packet->image) << end.count();
    EXPECT_EQ(packet->end, Time(end));
    EXPECT_EQ(packet->image->time, Time(end));
    EXPECT_EQ(packet->scan->end(), Time(end));
    EXPECT_EQ(packet->scan->points_L.size(), end == 50ms ? 5U : 10U);
    EXPECT_EQ(packet->scan->offsets.front(), Duration{0});
  }
}

TEST(PacketAssemblerWithImages, LosesAndDoublesNoPoint) {
  PacketAssembler assembler = scanned(2s);
  for (Duration t = 33ms; t < 1900ms; t += 97ms) assembler.push(image_at(t));
  std::vector<float> times;
  const auto take = [&](const std::optional<SensorPacket>& packet) {
    if (!packet) return false;
    EXPECT_TRUE(packet->scan);
    for (std::size_t i = 0; i < packet->scan->points_L.size(); ++i) {
      times.push_back(packet->scan->points_L[i].z());
      EXPECT_NEAR(times.back(), to_seconds(packet->scan->start + packet->scan->offsets[i]), 1e-6);
    }
    EXPECT_EQ(packet->scan->rings.size(), packet->scan->points_L.size());
    return true;
  };
  while (take(assembler.pop())) {
  }
  while (take(assembler.flush())) {
  }
  EXPECT_EQ(times.size(), 200U);
  EXPECT_TRUE(std::ranges::is_sorted(times));
}

TEST(PacketAssemblerWithImages, WaitsForALateImageAHundredAndFiftyMilliseconds) {
  PacketAssembler assembler = scanned(200ms);
  EXPECT_FALSE(assembler.pop()) << "an image within the first scan may still come";
  assembler.push(image_at(60ms));
  ASSERT_TRUE(assembler.pop());
  push_imu(assembler, 210ms, 260ms);
  const auto packet = assembler.pop();
  ASSERT_TRUE(packet) << "none came for 160 ms after the first scan's end";
  EXPECT_EQ(packet->end, Time(100ms));
  EXPECT_FALSE(packet->image);
  assembler.push(image_at(90ms));
  EXPECT_EQ(assembler.counts().images_too_late, 1);
}

TEST(PacketAssemblerWithImages, GoOnWhereTheLidarFallsSilent) {
  PacketAssembler assembler = scanned(100ms);
  assembler.push(image_at(100ms));
  ASSERT_TRUE(assembler.pop());
  push_imu(assembler, 110ms, 2000ms);
  for (Duration t = 200ms; t <= 1500ms; t += 100ms) assembler.push(image_at(t));
  int images = 0;
  while (const auto packet = assembler.pop()) {
    EXPECT_FALSE(packet->scan);
    images += packet->image ? 1 : 0;
  }
  EXPECT_EQ(images, 14);
}

TEST(PacketAssemblerWithImages, LeavesOutImagesThatFollowTooSoonAndAddsTheCamerasDelay) {
  Rig rig;
  rig.camera_delay = -10ms;
  PacketAssembler assembler{rig, with_images};
  push_imu(assembler, 0ms, 500ms);
  for (Duration t = 0ms; t < 500ms; t += 100ms) assembler.push(dense_scan_from(t));
  for (Duration t = 40ms; t < 400ms; t += 40ms) assembler.push(image_at(t));
  for (const Duration end : {30ms, 110ms, 190ms}) EXPECT_EQ(assembler.pop()->end, Time(end));
}

TEST(PacketAssembler, KeepsLittleImuDataBeforeTheFirstScan) {
  PacketAssembler assembler{Rig{}};
  push_imu(assembler, 0ms, 60s);
  assembler.push(scan_from(59800ms));
  const auto packet = assembler.pop();
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->imu.front().time, Time(59800ms));
}

}  // namespace
}  // namespace pllit
