#include "pllit/slam/health.hpp"

#include <gtest/gtest.h>

#include "pllit/slam/run.hpp"

namespace pllit {
namespace {

FrameFacts good_frame() {
  FrameFacts facts;
  facts.has_scan = facts.matched = true;
  facts.points = 1500;
  facts.candidates = 1200;
  facts.inliers = 1100;
  facts.residual_rms_m = 0.03;
  facts.speed_mps = 1.0;
  return facts;
}

TEST(Health, IsGoodWithoutReasonsOnAGoodFrame) {
  const Health health = assess(good_frame(), {});
  EXPECT_EQ(health.state, HealthState::good);
  EXPECT_THAT(health.reasons, testing::IsEmpty());
}

TEST(Health, SaysWhyAFrameIsDegraded) {
  const auto reason = [](auto change) {
    FrameFacts facts = good_frame();
    change(facts);
    const Health health = assess(facts, {});
    EXPECT_EQ(health.state, HealthState::degraded);
    return health.reasons.empty() ? "" : health.reasons.front();
  };
  EXPECT_THAT(reason([](FrameFacts& f) {
                f.localizability.degenerate = 1;
                f.localizability.worst[3] = 1.0;
              }),
              testing::HasSubstr("does not observe translation along (1.00, 0.00, 0.00)"));
  EXPECT_THAT(reason([](FrameFacts& f) { f.inliers = 400; }), testing::HasSubstr("33 %"));
  EXPECT_THAT(reason([](FrameFacts& f) { f.residual_rms_m = 0.4; }), testing::HasSubstr("0.40 m"));
  EXPECT_THAT(reason([](FrameFacts& f) { f.longest_imu_gap_s = 0.7; }), testing::HasSubstr("no IMU data for 0.70 s"));
  EXPECT_THAT(reason([](FrameFacts& f) {
                f.matched = false;
                f.inliers = 10;
              }),
              testing::HasSubstr("scan not matched: 10 points fit the map; at least 60 must"));
  EXPECT_THAT(reason([](FrameFacts& f) {
                f.matched = false;
                f.inliers = 200;
              }),
              testing::HasSubstr("scan not matched: 200 of 1200 points fit the map; at least 25 % must"));
  EXPECT_THAT(reason([](FrameFacts& f) {
                f.has_scan = f.matched = false;
                f.since_match_s = 1.5;
              }),
              testing::HasSubstr("LiDAR silent for 1.5 s"));
}

TEST(Health, IsLostAfterALongSilenceAnImpossibleSpeedOrANewMap) {
  FrameFacts silent = good_frame(), fast = good_frame(), restarted = good_frame();
  silent.has_scan = silent.matched = false;
  silent.since_match_s = 6.0;
  fast.speed_mps = 80.0;
  restarted.map_restarted = true;
  for (const FrameFacts& facts : {silent, fast, restarted}) EXPECT_EQ(assess(facts, {}).state, HealthState::lost);
}

TEST(Health, DoesNotAcceptAMatchOfAFewPointsOrASmallShare) {
  NormalEquations sums;
  sums.candidates = 1000;
  sums.inliers = 700;
  EXPECT_TRUE(match_accepted(sums, {}));
  sums.inliers = 100;
  EXPECT_FALSE(match_accepted(sums, {}));
  sums.candidates = sums.inliers = 20;
  EXPECT_FALSE(match_accepted(sums, {}));
}

TEST(RunVerdict, IsEmptyOnlyWhereTheWholeRunCanBeTrusted) {
  RunSummary summary;
  summary.frames = 100;
  summary.health = {0, 90, 10, 0};
  summary.final_state = HealthState::good;
  EXPECT_EQ(summary.doubts(), "");
  summary.final_state = HealthState::degraded;
  EXPECT_EQ(summary.doubts(), "degraded at the end");
  summary.health = {0, 86, 14, 0};
  summary.final_state = HealthState::good;
  EXPECT_EQ(summary.doubts(), "degraded in 14 of 100 frames, more than a tenth");
  summary.health = {0, 83, 14, 3};
  summary.final_state = HealthState::lost;
  EXPECT_EQ(summary.doubts(),
            "lost in 3 of 100 frames; degraded in 14 of 100 frames, more than a tenth; lost at the end");
}

}  // namespace
}  // namespace pllit
