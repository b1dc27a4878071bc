#include "pllit/slam/time_offset.hpp"

#include <gtest/gtest.h>

#include "pllit/sim/simulation.hpp"

namespace pllit {
namespace {

struct Recorded {
  std::vector<ImuSample> imu;
  std::vector<LidarScan> scans;
  Rig rig;
};

Recorded recorded(const std::string& address, Duration lidar_late_by) {
  auto simulation = open_simulation(address);
  Recorded data{.imu = {}, .scans = {}, .rig = simulation->rig()};
  while (const auto event = simulation->next().value()) {
    if (const auto* imu = std::get_if<ImuSample>(&event->data)) data.imu.push_back(*imu);
    if (const auto* scan = std::get_if<LidarScan>(&event->data)) {
      data.scans.push_back(*scan);
      data.scans.back().start += lidar_late_by;
    }
  }
  return data;
}

TEST(TimeOffset, IsFoundToThreeMilliseconds) {
  for (const int offset_ms : {-120, 0, 37, 210}) {
    const Recorded data =
        recorded("sim:box_room?duration=20&lidar=ring16&seed=3", std::chrono::milliseconds(-offset_ms));
    const TimeOffset offset = estimate_time_offset(data.imu, lidar_rotations(data.scans, data.rig, {}));
    ASSERT_TRUE(offset.found) << offset.reason;
    EXPECT_NEAR(offset.offset_s, offset_ms * 1e-3, 0.003);
  }
}

TEST(TimeOffset, IsNotClaimedWithoutTurns) {
  const Recorded data = recorded("sim:box_room?duration=3&lidar=ring16", Duration{0});
  const TimeOffset offset =
      estimate_time_offset(data.imu, lidar_rotations(std::span(data.scans).first(20), data.rig, {}));
  EXPECT_FALSE(offset.found);
  EXPECT_FALSE(offset.reason.empty());
}

}  // namespace
}  // namespace pllit
