#include "pllit/slam/odometry.hpp"

#include <gtest/gtest.h>

#include "pllit/eval/evaluate.hpp"
#include "support/simulated_run.hpp"

namespace pllit {
namespace {

struct Errors {
  double rms_m = 0.0, rms_deg = 0.0;
};

/// APE after SE(3) alignment.
Errors errors_of(const test::SimulatedRun& run) {
  Trajectory truth, estimate;
  for (const FrameEstimate& frame : run.frames) {
    truth.push_back({frame.posterior.mean.time, run.truth_at(frame)});
    estimate.push_back({frame.posterior.mean.time, frame.posterior.mean.T_W_I()});
  }
  const auto scores = evaluate(truth, estimate);
  EXPECT_TRUE(scores.has_value()) << scores.error().message;
  return {scores->ape.translation_m.rmse, scores->ape.rotation_deg.rmse};
}

TEST(Odometry, KeepsToACentimetreAndATenthOfADegreeInARoom) {
  for (const int seed : {1, 2, 3}) {
    const auto run = test::run_simulation("sim:box_room?duration=30&lidar=ring16&seed=" + std::to_string(seed));
    ASSERT_TRUE(run.result) << run.result.error().message;
    ASSERT_GT(run.frames.size(), 250u);
    EXPECT_LT(errors_of(run).rms_m, 0.01) << "seed " << seed;
    EXPECT_LT(errors_of(run).rms_deg, 0.1) << "seed " << seed;
    EXPECT_EQ(run.summary.count(HealthState::lost), 0);
    EXPECT_FALSE(run.summary.was_degraded());
  }
}

TEST(Odometry, SurvivesFastTurns) {
  const auto run = test::run_simulation("sim:box_room?duration=20&lidar=ring16&motion=shake&seed=4");
  ASSERT_TRUE(run.result) << run.result.error().message;
  EXPECT_LT(errors_of(run).rms_m, 0.02);
  EXPECT_LT(errors_of(run).rms_deg, 0.4);
}

TEST(Odometry, WorksWithAnImuOfTenToAThousandHertz) {
  for (const int rate_hz : {20, 100, 1000}) {
    const auto run =
        test::run_simulation("sim:box_room?duration=15&lidar=ring16&seed=5&imu_rate=" + std::to_string(rate_hz));
    ASSERT_TRUE(run.result) << run.result.error().message;
    EXPECT_LT(errors_of(run).rms_m, 0.02) << rate_hz << " Hz";
  }
}

TEST(Odometry, GivesTheSameBytesForAnyNumberOfThreads) {
  Config one, four;
  one.threads = 1;
  four.threads = 4;
  const std::string address = "sim:box_room?duration=6&lidar=ring16&seed=6";
  const auto a = test::run_simulation(address, one), b = test::run_simulation(address, four);
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    EXPECT_EQ(a.frames[i].posterior.mean.p_W, b.frames[i].posterior.mean.p_W);
    EXPECT_EQ(a.frames[i].posterior.covariance, b.frames[i].posterior.covariance);
  }
}

TEST(Odometry, EstimatesTheSameFromAnAccelerometerInG) {
  const auto si = test::run_simulation("sim:box_room?duration=8&lidar=ring16&seed=7");
  const auto in_g = test::run_simulation("sim:box_room?duration=8&lidar=ring16&seed=7&accel_unit=g");
  ASSERT_TRUE(in_g.summary.start);
  EXPECT_EQ(in_g.summary.start->unit, AccelUnit::g);
  EXPECT_LT((si.frames.back().posterior.mean.p_W - in_g.frames.back().posterior.mean.p_W).norm(), 1e-6);
}

TEST(Odometry, LosesNoScanToItsStart) {
  const auto run = test::run_simulation("sim:box_room?duration=5&lidar=ring16&seed=8");
  EXPECT_GE(run.frames.size(), 49u);
  EXPECT_TRUE(run.summary.start->still);  // although the simulated gyroscope has a bias of a degree a second
}

/// A recording whose first scan has lost all but some points, as where an image cuts it off.
class FirstScanCutShort : public EventSource {
 public:
  FirstScanCutShort(EventSource& source, std::size_t points) : source_(source), points_(points) {}
  Expected<std::optional<SensorEvent>> next() override {
    auto event = source_.next();
    if (!event || !*event || cut_) return event;
    if (auto* scan = std::get_if<LidarScan>(&(*event)->data)) {
      cut_ = true;
      scan->points_L.resize(points_);
      scan->offsets.resize(points_);
      scan->intensity.resize(points_);
      scan->rings.resize(std::min(points_, scan->rings.size()));
    }
    return event;
  }

 private:
  EventSource& source_;
  std::size_t points_;
  bool cut_ = false;
};

TEST(Odometry, TakesAFirstScanOfAFewPointsForNoMapYet) {
  auto simulation = open_simulation("sim:box_room?duration=5&lidar=ring16&seed=8");
  FirstScanCutShort source(*simulation, 300);
  RunSummary summary;
  const Rig rig = simulation->rig();
  const auto result =
      run_odometry(source, rig, {}, {.sink = [](const FrameEstimate&) -> Expected<void> { return {}; }}, summary);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(summary.count(HealthState::good), summary.frames);
}

TEST(Odometry, RefusesARecordingThatIsTooShortToStart) {
  auto simulation = open_simulation("sim:box_room?duration=3&lidar=ring16");
  Config config;
  config.start.window_s = 30.0;
  const Rig rig = simulation->rig();
  RunSummary summary;
  const auto result = run_odometry(*simulation, rig, config,
                                   {.sink = [](const FrameEstimate&) -> Expected<void> { return {}; }}, summary);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, Error::Kind::input);
  EXPECT_THAT(result.error().message, testing::HasSubstr("before the odometry could start"));
}

}  // namespace
}  // namespace pllit
