#include "pllit/eval/associate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/paths.hpp"

namespace pllit {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kSpeed_mps = 2.0;
constexpr double kTurn_degps = 15.0;

/// A body that moves along (1, 2, 2) / 3 at constant speed and turns at a constant rate about a fixed axis.
Trajectory steady(double first_s, double last_s, double step_s) {
  Trajectory trajectory;
  for (double t = first_s; t < last_s + 1e-9; t += step_s)
    trajectory.push_back(
        {at(t), pose_from(turn(Vector3d(1, 1, 4), kTurn_degps * t), kSpeed_mps * t * Vector3d(1, 2, 2) / 3.0)});
  return trajectory;
}

TEST(Association, IsExactOnASteadyMotionWhateverTheRates) {
  const Trajectory truth = steady(0.0, 10.0, 0.04), estimate = steady(0.037, 9.9, 0.1);
  for (const auto& [a, b] : {std::pair{truth, estimate}, std::pair{estimate, truth}})
    for (const AssociationTimes times : {AssociationTimes::sparser, AssociationTimes::truth}) {
      const auto pairs = associate(a, b, {.times = times});
      ASSERT_TRUE(pairs) << pairs.error().message;
      for (const PosePair& pair : *pairs) EXPECT_TRUE(pair.T_W_I.isApprox(pair.T_V_I, 1e-9)) << to_seconds(pair.time);
    }
}

TEST(Association, TakesTheTimesOfTheSparserTrajectory) {
  const Trajectory dense = steady(0.0, 10.0, 0.01), sparse = steady(0.005, 9.0, 1.0);  // 0.005, 1.005, ... 8.005
  const auto as_truth = associate(sparse, dense),
             as_estimate = associate(dense, sparse, {.max_gap = from_seconds(2.0)});
  ASSERT_TRUE(as_truth && as_estimate);
  ASSERT_EQ(as_truth->size(), 9u);
  ASSERT_EQ(as_estimate->size(), 9u);
  EXPECT_EQ(as_truth->at(3).time, sparse[3].time);
  EXPECT_EQ(as_estimate->at(3).time, sparse[3].time);
}

TEST(Association, TakesTheTimesOfTheTruthWhenAsked) {
  const Trajectory dense = steady(0.0, 1.0, 0.01), sparse = steady(0.0, 1.0, 0.1);
  EXPECT_EQ(associate(dense, sparse, {.times = AssociationTimes::truth})->size(), dense.size());
  EXPECT_EQ(associate(dense, sparse, {.times = AssociationTimes::sparser})->size(), sparse.size());
}

TEST(Association, KeepsATimeOffsetVisible) {
  // Stamps that are 50 ms late at 2 m/s: every pose is 0.1 m behind.
  Trajectory late = steady(0.0, 10.0, 0.1);
  for (StampedPose& pose : late) pose.time += from_seconds(0.05);
  const auto pairs = associate(steady(0.0, 10.0, 0.1), late);
  ASSERT_TRUE(pairs) << pairs.error().message;
  for (const PosePair& pair : *pairs)
    EXPECT_NEAR((pair.T_W_I.translation() - pair.T_V_I.translation()).norm(), 0.1, 1e-9);
}

TEST(Association, BridgesNoGapLongerThanAllowed) {
  Trajectory estimate = steady(0.0, 1.0, 0.1);
  const Trajectory after = steady(2.0, 3.0, 0.1), truth = steady(0.05, 2.95, 0.1);  // 30 truth poses, 10 in the gap
  estimate.insert(estimate.end(), after.begin(), after.end());
  const AssociationTimes times = AssociationTimes::truth;
  EXPECT_EQ(associate(truth, estimate, {.times = times, .max_gap = from_seconds(0.5)})->size(), 20u);
  EXPECT_EQ(associate(truth, estimate, {.times = times, .max_gap = from_seconds(1.5)})->size(), 30u);
}

TEST(Association, NeverExtrapolates) {
  const auto pairs = associate(steady(0.0, 10.0, 0.1), steady(4.02, 6.03, 0.1), {.times = AssociationTimes::truth});
  ASSERT_TRUE(pairs);
  EXPECT_GE(pairs->front().time, at(4.02));
  EXPECT_LE(pairs->back().time, at(6.03));
  EXPECT_EQ(pairs->size(), 20u);  // 4.1, 4.2, ... 6.0
}

TEST(Association, NamesBothSpansWhereNoTimeIsCommon) {
  const auto pairs = associate(steady(0.0, 1.0, 0.1), steady(100.0, 101.0, 0.1));
  ASSERT_FALSE(pairs);
  EXPECT_EQ(pairs.error().kind, Error::Kind::input);
  EXPECT_THAT(pairs.error().message, AllOf(HasSubstr("truth runs from 0.000 s to 1.000 s"),
                                           HasSubstr("estimate runs from 100.000 s to 101.000 s")));
}

TEST(Association, SaysThatATrajectoryIsEmpty) {
  EXPECT_THAT(associate(steady(0.0, 1.0, 0.1), {}).error().message, HasSubstr("the estimate is empty"));
  EXPECT_THAT(associate({}, steady(0.0, 1.0, 0.1)).error().message, HasSubstr("the truth is empty"));
}

}  // namespace
}  // namespace pllit
