#include "pllit/slam/loop_stage.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "pllit/eval/evaluate.hpp"
#include "pllit/io/bag_reader.hpp"
#include "pllit/io/tum.hpp"
#include "pllit/slam/config_presets.hpp"
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

/// The recording's even scans as they came, and its odd scans backwards from the end to the start.
struct ForthAndBack {
  std::vector<SensorEvent> forth, back;
  Time turn;
};

ForthAndBack forth_and_back(EventSource& source) {
  ForthAndBack made;
  int scans = 0;
  while (auto event = source.next().value()) {
    if (const auto* imu = std::get_if<ImuSample>(&event->data)) {
      made.forth.push_back(*event);
      made.back.push_back(*event);
      made.turn = imu->time;
    } else if (std::holds_alternative<LidarScan>(event->data)) {
      (scans++ % 2 == 0 ? made.forth : made.back).push_back(*event);
    }
  }
  for (SensorEvent& event : made.back) event = backwards(event, made.turn);
  std::ranges::stable_sort(made.back, {}, &SensorEvent::received);
  return made;
}

/// An odometry's keyframes with the poses of all its frames. The car does not stop where the recording is turned, so each way has
/// an odometry of its own.
struct Leg {
  std::vector<LoopKeyframe> keyframes;
  std::vector<SE3> frames_O_I;
};

Leg odometry_of(std::vector<SensorEvent> events, const Config& config) {
  Leg leg;
  KeyframeMaker maker(config.loop.keyframes);
  RunSummary summary;
  Recorded source(std::move(events));
  const auto done = run_odometry(source, make_rig(config.rig), config,
                                 {.sink = [&](const FrameEstimate& frame) -> Expected<void> {
                                   leg.frames_O_I.push_back(frame.posterior.mean.T_W_I());
                                   if (auto keyframe = maker.take(frame)) leg.keyframes.push_back(std::move(*keyframe));
                                   return {};
                                 }},
                                 summary);
  EXPECT_TRUE(done) << done.error().message;
  EXPECT_EQ(summary.count(HealthState::lost), 0);
  return leg;
}

TEST(LoopCloser, ClosesARealDriveForthAndBackOnItself) {
  PLLIT_RECORDING(path, "kitti_0005/kitti_0005.bag");
  auto bag = open_bags({path});
  ASSERT_TRUE(bag) << bag.error().message;
  ForthAndBack made = forth_and_back(**bag);
  const auto config = find_config("kitti");
  ASSERT_TRUE(config) << config.error().message;
  const Leg forth = odometry_of(std::move(made.forth), *config), back = odometry_of(std::move(made.back), *config);
  ASSERT_GT(forth.frames_O_I.size(), 60u);
  ASSERT_GT(back.frames_O_I.size(), 60u);

  // The way back begins where the last scan of the way forth ended.
  const SE3 T_O_back = forth.frames_O_I.back() * back.frames_O_I.front().inverse();
  std::vector<LoopKeyframe> keyframes = forth.keyframes;
  const double forth_m = keyframes.back().way_m;
  for (LoopKeyframe keyframe : back.keyframes) {
    keyframe.T_O_I = T_O_back * keyframe.T_O_I;
    keyframe.way_m += forth_m;
    if (keyframe.step_covariance.isZero())
      keyframe.step_covariance = 1e-4 * Matrix6::Identity();  // of the joint
    keyframes.push_back(std::move(keyframe));
  }
  LoopCloser closer(config->loop);
  for (const LoopKeyframe& keyframe : keyframes) closer.add(keyframe);
  closer.finish();

  // The truth at each keyframe: on the way back that of the mirrored time.
  const auto recorded = read_tum(std::filesystem::path(path).replace_extension("kiss.tum"));
  ASSERT_TRUE(recorded) << recorded.error().message;
  Trajectory truth, before, after;
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const Time time = keyframes[k].time;
    const auto at = pose_at(*recorded, k < forth.keyframes.size() ? time : made.turn + (made.turn - time), std::chrono::seconds(1));
    if (!at) continue;
    truth.push_back({time, *at});
    before.push_back({time, keyframes[k].T_O_I});
    after.push_back({time, closer.poses_M()[k]});
  }
  const double before_m = evaluate(truth, before)->ape.translation_m.rmse, after_m = evaluate(truth, after)->ape.translation_m.rmse;
  RecordProperty("ape_before_m", std::to_string(before_m));
  RecordProperty("ape_after_m", std::to_string(after_m));
  RecordProperty("accepted", closer.accepted());
  RecordProperty("refused", static_cast<int>(closer.records().size()) - closer.accepted());
  EXPECT_GE(closer.accepted(), 3);
  EXPECT_LT(after_m, std::max(0.3, before_m / 3.0));
  for (const LoopRecord& record : closer.records()) {
    if (!record.accepted) continue;
    const auto a = pose_at(truth, record.earlier_time, std::chrono::seconds(1)), b = pose_at(truth, record.later_time, std::chrono::seconds(1));
    ASSERT_TRUE(a && b);
    EXPECT_LT(difference(a->inverse() * *b, record.T_earlier_later).tail<3>().norm(), 0.5);
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
