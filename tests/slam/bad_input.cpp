// What goes wrong with sensors must show in the health record, and must not harm what was already estimated.
#include <gtest/gtest.h>

#include "support/simulated_run.hpp"

namespace pllit {
namespace {

double final_error_m(const test::SimulatedRun& run) {
  return test::relative_error_W(run, run.frames.front(), run.frames.back()).tail<3>().norm();
}

std::string with_fault(const std::string& fault) { return "sim:box_room?duration=16&lidar=ring16&seed=11&" + fault; }

/// States of the frames between two times since the first frame.
int count_between(const test::SimulatedRun& run, double from_s, double to_s, HealthState state) {
  int count = 0;
  for (const FrameEstimate& frame : run.frames) {
    const double t = to_seconds(frame.posterior.mean.time - run.frames.front().posterior.mean.time);
    count += t >= from_s && t < to_s && frame.health.state == state;
  }
  return count;
}

TEST(SilentLidar, IsBridgedByTheImuForTwoSecondsWithoutBeingLost) {
  const auto run = test::run_simulation(with_fault("lidar_gap=8:10"));
  ASSERT_TRUE(run.result);
  EXPECT_GT(count_between(run, 8.0, 10.5, HealthState::degraded), 5);
  EXPECT_EQ(run.summary.count(HealthState::lost), 0);
  EXPECT_EQ(run.summary.final_state, HealthState::good);
  EXPECT_LT(final_error_m(run), 0.02);
}

TEST(SensorsThatFallSilentForGood, AreNeverCalledGood) {
  const auto blind = test::run_simulation(with_fault("lidar_gap=8:99"));
  EXPECT_TRUE(blind.result);
  EXPECT_EQ(count_between(blind, 8.5, 99.0, HealthState::good), 0);
  EXPECT_EQ(blind.summary.final_state, HealthState::lost);
  const auto numb = test::run_simulation(with_fault("imu_gap=8:99"));
  EXPECT_TRUE(numb.result);
  EXPECT_EQ(count_between(numb, 8.5, 99.0, HealthState::good), 0);
  EXPECT_NE(numb.summary.final_state, HealthState::good);
  for (const FrameEstimate& frame : numb.frames) EXPECT_TRUE(frame.posterior.covariance.allFinite());
}

TEST(MissingImuData, IsADegradationFromWhichItRecovers) {
  const auto run = test::run_simulation(with_fault("imu_gap=8:9"));
  ASSERT_TRUE(run.result);
  EXPECT_GT(run.summary.count(HealthState::degraded), 0);
  EXPECT_EQ(run.summary.final_state, HealthState::good);
  EXPECT_LT(final_error_m(run), 0.05);
  for (const FrameEstimate& frame : run.frames) EXPECT_TRUE(frame.posterior.covariance.allFinite());
}

TEST(NonFiniteImuSamples, AreDroppedAndTold) {
  const auto run = test::run_simulation(with_fault("imu_nan=8:8.1"));
  ASSERT_TRUE(run.result);
  EXPECT_THAT(run.summary.notes, testing::Contains(testing::HasSubstr("not finite")));
  EXPECT_LT(final_error_m(run), 0.02);
}

TEST(DuplicatedMessages, ChangeNothing) {
  const auto clean = test::run_simulation("sim:box_room?duration=16&lidar=ring16&seed=11");
  const auto run = test::run_simulation(with_fault("duplicates=5:9"));
  ASSERT_TRUE(run.result);
  EXPECT_THAT(run.summary.notes, testing::Contains(testing::HasSubstr("duplicates")));
  ASSERT_EQ(run.frames.size(), clean.frames.size());
  EXPECT_EQ(run.frames.back().posterior.mean.p_W, clean.frames.back().posterior.mean.p_W);
}

TEST(StampsThatStepBack, AreDroppedAndTold) {
  const auto run = test::run_simulation(with_fault("time_back=8:8.5"));
  ASSERT_TRUE(run.result);
  EXPECT_THAT(run.summary.notes, testing::Contains(testing::HasSubstr("stepped back")));
  for (std::size_t i = 1; i < run.frames.size(); ++i)
    EXPECT_GT(run.frames[i].posterior.mean.time, run.frames[i - 1].posterior.mean.time);
  EXPECT_LT(final_error_m(run), 0.1);
}

TEST(LateScansAndSwappedSamples, DoNoHarm) {
  for (const std::string fault : {"late_scans=5:12", "swapped_imu=8:9"}) {
    const auto run = test::run_simulation(with_fault(fault));
    ASSERT_TRUE(run.result) << fault;
    EXPECT_LT(final_error_m(run), 0.02) << fault;
    EXPECT_EQ(run.summary.count(HealthState::lost), 0) << fault;
  }
}

TEST(AFailingSink, EndsTheRunWithItsReason) {
  auto simulation = open_simulation("sim:box_room?duration=5&lidar=ring16");
  const Rig rig = simulation->rig();
  RunSummary summary;
  int taken = 0;
  const auto full_disk = [&taken](const FrameEstimate&) -> Expected<void> {
    return ++taken < 20 ? Expected<void>{} : failure("no space left on the device");
  };
  const auto result = run_odometry(*simulation, rig, {}, {.sink = full_disk}, summary);
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, testing::HasSubstr("no space left"));
  EXPECT_EQ(taken, 20);
}

TEST(AStopRequest, EndsTheRunWhereItIs) {
  auto simulation = open_simulation("sim:box_room?duration=10&lidar=ring16");
  const Rig rig = simulation->rig();
  RunSummary summary;
  std::stop_source stop;
  const auto result = run_odometry(*simulation, rig, {},
                                   {.sink = [&](const FrameEstimate&) -> Expected<void> {
                                      if (summary.frames == 30) stop.request_stop();
                                      return {};
                                    },
                                    .stop = stop.get_token()},
                                   summary);
  EXPECT_TRUE(result);
  EXPECT_TRUE(summary.interrupted);
  EXPECT_EQ(summary.frames, 30);
}

}  // namespace
}  // namespace pllit
