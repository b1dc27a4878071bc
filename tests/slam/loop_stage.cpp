#include "pllit/slam/loop_stage.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "pllit/io/bag_reader.hpp"
#include "pllit/slam/config_yaml.hpp"
#include "pllit/slam/run.hpp"
#include "support/recordings.hpp"

namespace pllit {
namespace {

/// Events that lie in memory.
class Recorded : public EventSource {
 public:
  explicit Recorded(std::vector<SensorEvent> events) : events_(std::move(events)) {}
  Expected<std::optional<SensorEvent>> next() override {
    if (at_ == events_.size()) return std::nullopt;
    return events_[at_++];
  }

 private:
  std::vector<SensorEvent> events_;
  std::size_t at_ = 0;
};

/// The same motion backwards, `mirror` being the instant that stays: rates change sign, forces do not.
SensorEvent backwards(const SensorEvent& event, Time mirror) {
  const auto mirrored = [&](Time time) { return mirror + (mirror - time); };
  if (const auto* imu = std::get_if<ImuSample>(&event.data))
    return {mirrored(event.received), ImuSample{mirrored(imu->time), -imu->gyro_rps, imu->accel_mps2}};
  LidarScan scan = std::get<LidarScan>(event.data);
  const Duration length = scan.offsets.empty() ? Duration(0) : scan.offsets.back();
  scan.start = mirrored(scan.end());
  std::ranges::reverse(scan.points_L);
  std::ranges::reverse(scan.offsets);
  std::ranges::reverse(scan.intensity);
  std::ranges::reverse(scan.rings);
  for (Duration& offset : scan.offsets) offset = length - offset;
  return {scan.end(), std::move(scan)};
}

struct ForthAndBack {
  std::vector<SensorEvent> events;
  Time turn;
  std::vector<Time> forth_times;  ///< ends of the scans of the way forth
};

/// The recording's even scans, then from its end its odd scans back to the start.
ForthAndBack forth_and_back(EventSource& source) {
  ForthAndBack made;
  std::vector<SensorEvent> back;
  int scans = 0;
  while (auto event = source.next().value()) {
    if (std::holds_alternative<ImuSample>(event->data)) {
      made.events.push_back(*event);
      back.push_back(*event);
      made.turn = std::get<ImuSample>(event->data).time;
    } else if (const auto* scan = std::get_if<LidarScan>(&event->data)) {
      if (scans++ % 2 == 0) made.forth_times.push_back(scan->end());
      (scans % 2 == 1 ? made.events : back).push_back(*event);
    }
  }
  std::vector<SensorEvent> turned;
  for (const SensorEvent& event : back) turned.push_back(backwards(event, made.turn));
  std::ranges::stable_sort(turned, {}, [](const SensorEvent& event) { return event.received; });
  for (SensorEvent& event : turned)  // the instant of turning is there already
    if (!std::holds_alternative<ImuSample>(event.data) || std::get<ImuSample>(event.data).time > made.turn)
      made.events.push_back(std::move(event));
  return made;
}

TEST(LoopStage, ClosesARealDriveForthAndBackOnItself) {
  PLLIT_RECORDING(path, "kitti_0005/kitti_0005.bag");
  auto bag = open_bags({path});
  ASSERT_TRUE(bag) << bag.error().message;
  ForthAndBack made = forth_and_back(**bag);
  const auto config = read_config("kitti", {});
  ASSERT_TRUE(config) << config.error().message;

  LoopStage loops(config->loop);
  Trajectory odometry;
  RunSummary summary;
  Recorded source(std::move(made.events));
  const auto done =
      run_odometry(source, make_rig(config->rig), *config, {.sink = [&](const FrameEstimate& frame) -> Expected<void> {
                     loops.take(frame);
                     odometry.push_back({frame.posterior.mean.time, frame.posterior.mean.T_W_I()});
                     return {};
                   }},
                   summary);
  ASSERT_TRUE(done) << done.error().message;
  const LoopResult result = loops.finish();

  // Forth and back the car was at the same place at times that mirror each other.
  const auto gap_m = [&](const Trajectory& trajectory) {
    double worst = 0.0;
    for (const Time forth : made.forth_times) {
      const auto a = pose_at(trajectory, forth, std::chrono::seconds(1));
      const auto b = pose_at(trajectory, made.turn + (made.turn - forth), std::chrono::seconds(1));
      if (a && b) worst = std::max(worst, (a->translation() - b->translation()).norm());
    }
    return worst;
  };
  const double before_m = gap_m(odometry), after_m = gap_m(result.correction.corrected(odometry));
  RecordProperty("gap_before_m", std::to_string(before_m));
  RecordProperty("gap_after_m", std::to_string(after_m));
  RecordProperty("accepted", result.accepted);
  RecordProperty("refused", static_cast<int>(result.records.size()) - result.accepted);
  EXPECT_GE(result.accepted, 3);
  EXPECT_GT(before_m, 0.0);
  EXPECT_LT(after_m, std::max(0.3, before_m / 3.0));
  for (const LoopRecord& record : result.records) {
    if (!record.accepted) continue;
    // A right loop joins places whose times mirror each other, give or take the way between anchors at 5 m/s.
    EXPECT_LT(record.T_earlier_later.translation().norm(), 7.0);
  }
}

TEST(LoopStage, FinishesWithNothingAndCanBeGivenUp) {
  LoopStage nothing({});
  const LoopResult result = nothing.finish();
  EXPECT_EQ(result.accepted, 0);
  EXPECT_TRUE(result.records.empty());
  const SE3 somewhere = pose_from(SO3::Identity(), Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(result.correction.pose_M(Time{}, somewhere).coeffs(), somewhere.coeffs());
  LoopStage given_up({});
  given_up.take({});
}

}  // namespace
}  // namespace pllit
