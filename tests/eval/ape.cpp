#include "pllit/eval/ape.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/paths.hpp"
#include "pllit/eval/align.hpp"

namespace pllit {
namespace {

using namespace test;

AbsoluteError error_after(const std::vector<PosePair>& pairs, Alignment alignment) {
  return absolute_error(aligned(pairs, alignment_of(pairs, alignment).value()));
}

TEST(AbsoluteError, AgreesWithFiguresWorkedByHand) {
  // Errors 0, 1, 2 and |(3, 0, 4)| = 5: squares 0 + 1 + 4 + 25 = 30, mean square 7.5; mean 8 / 4 = 2; median of
  // 0 1 2 5 is (1 + 2) / 2; variance 7.5 - 2 * 2 = 3.5.
  const auto truth = straight(4);
  const std::vector<SE3> estimate{moved_to(0, 0, 0), moved_to(1, 1, 0), moved_to(2, 0, -2), moved_to(6, 0, 4)};
  const Statistics s = absolute_error(pairs_of(truth, estimate)).translation_m;
  EXPECT_NEAR(s.rmse, std::sqrt(7.5), 1e-12);
  EXPECT_NEAR(s.mean, 2.0, 1e-12);
  EXPECT_NEAR(s.median, 1.5, 1e-12);
  EXPECT_NEAR(s.std, std::sqrt(3.5), 1e-12);
  EXPECT_NEAR(s.max, 5.0, 1e-12);
}

TEST(AbsoluteError, TakesTheMiddleValueOfAnOddNumberAsMedian) {
  const std::vector<double> values{9.0, 1.0, 4.0};
  EXPECT_DOUBLE_EQ(statistics_of(values).median, 4.0);
}

TEST(AbsoluteError, ListsWhereAndHowFarEachPoseIsOff) {
  const auto truth = straight(3);
  const std::vector<SE3> estimate{moved_to(0, 0, 0), moved_to(1, -0.5, 0), pose_from(yaw(-20.0), Vector3d(2, 0, 1))};
  const auto samples = absolute_error(pairs_of(truth, estimate)).samples;
  ASSERT_EQ(samples.size(), 3u);
  EXPECT_EQ(samples[2].time, at(2.0));
  EXPECT_NEAR(samples[2].distance_m, 2.0, 1e-12);
  EXPECT_TRUE(samples[1].error_W_m.isApprox(Vector3d(0, -0.5, 0), 1e-12));
  EXPECT_TRUE(samples[2].error_W_m.isApprox(Vector3d(0, 0, 1), 1e-12));
  EXPECT_NEAR(samples[2].yaw_deg, -20.0, 1e-9);
  EXPECT_NEAR(samples[2].rotation_deg, 20.0, 1e-9);
}

TEST(AbsoluteError, IsTheSameWhereverTheEstimateHasItsWorld) {
  const auto truth = wandering(150, 11);
  const auto estimate = disturbed(truth, 0.2, 0.05, 12);
  const auto here = error_after(pairs_of(truth, estimate), Alignment::se3);
  const auto there = error_after(pairs_of(truth, seen_from(far_motion(), estimate)), Alignment::se3);
  EXPECT_GT(here.translation_m.rmse, 0.1);
  EXPECT_NEAR(there.translation_m.rmse, here.translation_m.rmse, 1e-9);
  EXPECT_NEAR(there.translation_m.max, here.translation_m.max, 1e-9);
  EXPECT_NEAR(there.rotation_deg.rmse, here.rotation_deg.rmse, 1e-7);
}

/// A level circle of radius 5 m.
std::vector<SE3> circle() {
  std::vector<SE3> poses;
  for (int i = 0; i < 72; ++i)
    poses.push_back(pose_from(yaw(5.0 * i), yaw(5.0 * i).rotation() * Vector3d(0.0, -5.0, 0.0)));
  return poses;
}

TEST(AbsoluteError, ShowsATiltThatYawAlignmentMustNotHide) {
  // The circle rotated by a tilt of 10 degrees about x, then by 40 about z. In the plane the tilt shrinks y by cos 10,
  // so the best heading is still -40, and 10 degrees stay in every rotation. Positions: z is off by y sin 10, y by y (1
  // - cos 10); with the mean square of y = 25 / 2, rmse = 5 / sqrt(2) * sqrt(2 - 2 cos 10) = 10 / sqrt(2) sin 5.
  const SE3 T_V_W = pose_from(yaw(40.0) * turn(Vector3d::UnitX(), 10.0), Vector3d(1.0, 2.0, 3.0));
  const auto pairs = pairs_of(circle(), seen_from(T_V_W, circle()));
  const auto by_yaw = error_after(pairs, Alignment::yaw);
  EXPECT_NEAR(by_yaw.rotation_deg.mean, 10.0, 1e-7);
  EXPECT_NEAR(by_yaw.translation_m.rmse, 10.0 / std::sqrt(2.0) * std::sin(radians(5.0)), 1e-9);
  EXPECT_NEAR(error_after(pairs, Alignment::se3).translation_m.max, 0.0, 1e-9);
}

TEST(AbsoluteError, ShowsAShiftThatNoAlignmentMustNotHide) {
  const auto pairs = pairs_of(circle(), seen_from(moved_to(0.0, 3.0, 4.0), circle()));
  EXPECT_NEAR(error_after(pairs, Alignment::none).translation_m.rmse, 5.0, 1e-12);
  EXPECT_NEAR(error_after(pairs, Alignment::yaw).translation_m.rmse, 0.0, 1e-9);
}

}  // namespace
}  // namespace pllit
