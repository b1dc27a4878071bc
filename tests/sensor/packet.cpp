#include "pllit/sensor/packet.hpp"

#include <gtest/gtest.h>

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
