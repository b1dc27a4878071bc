#include "pllit/eval/rpe.hpp"

#include <gtest/gtest.h>

#include "eval/paths.hpp"

namespace pllit {
namespace {

using namespace test;

TEST(RelativeError, OfAOnePercentScaleErrorIsOnePercent) {
  const auto truth = straight(201);
  std::vector<SE3> longer;
  for (const SE3& pose : truth) longer.push_back(pose_from(pose.asSO3(), 1.01 * pose.translation()));
  for (const double delta_m : {1.0, 10.0, 100.0}) {
    const RelativeError error = relative_error(pairs_of(truth, longer), delta_m);
    EXPECT_GT(error.pairs, 100u);
    EXPECT_NEAR(error.percent, 1.0, 1e-9);
    EXPECT_NEAR(error.rmse_m, 0.01 * delta_m, 0.006 * 0.01 * delta_m) << "the last pairs are up to a tenth shorter";
    EXPECT_NEAR(error.rotation_deg, 0.0, 1e-7);
  }
}

TEST(RelativeError, AgreesWithASideStepWorkedByHand) {
  // Eleven poses a metre apart; from the sixth on the estimate is 0.3 m to the left. Over 2 m there are nine pairs (i,
  // i + 2); the step lies between i and i + 2 for i = 3 and 4: rmse = sqrt(2 * 0.3^2 / 9) = 0.3 sqrt(2) / 3.
  const auto truth = straight(11);
  std::vector<SE3> estimate = truth;
  for (std::size_t i = 5; i < 11; ++i) estimate[i] = moved_to(static_cast<double>(i), 0.3, 0.0);
  const RelativeError error = relative_error(pairs_of(truth, estimate), 2.0);
  EXPECT_EQ(error.pairs, 9u);
  EXPECT_NEAR(error.rmse_m, 0.1 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(error.percent, 5.0 * std::sqrt(2.0), 1e-10);  // of 2 m
}

TEST(RelativeError, SplitsATurnIntoHeadingAndTheRestForABodyMountedOnItsSide) {
  // The body's x axis points down, so heading is a turn about its x axis. The estimate turns by 0.1 degrees a metre
  // about the world's z, then about the world's x: 1 degree over 10 m, all heading or none. Poses lie 2 m apart, so
  // that no pair is shorter than 10 m.
  const SO3 mounting = turn(Vector3d::UnitY(), 90.0);
  for (const auto& [axis, heading_deg] : {std::pair{Vector3d(0, 0, 1), 1.0}, std::pair{Vector3d(1, 0, 0), 0.0}}) {
    std::vector<SE3> truth, estimate;
    for (int i = 0; i <= 50; i += 2) {
      truth.push_back(pose_from(mounting, Vector3d(i, 0, 0)));
      estimate.push_back(pose_from(turn(axis, 0.1 * i) * mounting, Vector3d(i, 0, 0)));
    }
    const RelativeError error = relative_error(pairs_of(truth, estimate), 10.0);
    EXPECT_NEAR(error.rotation_deg, 1.0, 1e-7);
    EXPECT_NEAR(error.yaw_deg, heading_deg, 1e-7);
  }
}

TEST(RelativeError, IsTheSameWhereverTheEstimateHasItsWorld) {
  const auto truth = wandering(300, 21), estimate = disturbed(truth, 0.1, 0.02, 22);
  const RelativeError here = relative_error(pairs_of(truth, estimate), 5.0);
  const RelativeError there = relative_error(pairs_of(truth, seen_from(far_motion(), estimate)), 5.0);
  EXPECT_GT(here.rmse_m, 0.05);
  EXPECT_GT(here.yaw_deg, 0.1);
  EXPECT_NEAR(there.rmse_m, here.rmse_m, 1e-9);
  EXPECT_NEAR(there.yaw_deg, here.yaw_deg, 1e-7);
  EXPECT_NEAR(there.rotation_deg, here.rotation_deg, 1e-7);
}

/// The definition, read aloud: from each pose look at every later one and keep the first that is nearest to delta.
double naive_rmse_m(const std::vector<PosePair>& pairs, double delta_m, std::size_t& count) {
  double squares = 0.0;
  count = 0;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i) {
    double travelled_m = 0.0, nearest_m = 1e9;
    std::size_t partner = i;
    for (std::size_t j = i + 1; j < pairs.size(); ++j) {
      travelled_m += (pairs[j].T_W_I.translation() - pairs[j - 1].T_W_I.translation()).norm();
      if (std::abs(travelled_m - delta_m) < nearest_m - 1e-9) {
        nearest_m = std::abs(travelled_m - delta_m);
        partner = j;
      }
    }
    if (nearest_m > 0.1 * delta_m) continue;
    const SE3 truth = pairs[i].T_W_I.inverse() * pairs[partner].T_W_I;
    const SE3 estimate = pairs[i].T_V_I.inverse() * pairs[partner].T_V_I;
    squares += (truth.inverse() * estimate).translation().squaredNorm();
    ++count;
  }
  return std::sqrt(squares / static_cast<double>(count));
}

TEST(RelativeError, EqualsItsNaiveTwinOnAPathThatStandsStillNowAndThen) {
  const auto truth = wandering(400, 23);
  const auto pairs = pairs_of(truth, disturbed(truth, 0.1, 0.02, 24));
  for (const double delta_m : {0.5, 3.0, 20.0}) {
    std::size_t count = 0;
    const double rmse_m = naive_rmse_m(pairs, delta_m, count);
    const RelativeError error = relative_error(pairs, delta_m);
    EXPECT_GT(count, 100u);
    EXPECT_EQ(error.pairs, count);
    EXPECT_NEAR(error.rmse_m, rmse_m, 1e-9);
  }
}

TEST(MotionError, IsThatOfTheLaterPoseInTheEstimatesWorldWhereverThatLies) {
  const auto truth = wandering(2, 31);
  const Vector6 pushed = (Vector6() << 0.02, -0.01, 0.03, 0.1, -0.2, 0.05).finished();  // (theta, p) in V
  const SE3 T_V_W = pose_from(exp_so3({0.2, -0.1, 2.0}), {3.0, -2.0, 1.1});
  const SE3 from = T_V_W * truth[0], exact = T_V_W * truth[1];
  const SE3 to = pose_from(exp_so3(Vector3d(pushed.head<3>())) * exact.asSO3(), exact.translation() + pushed.tail<3>());
  const Vector6 error =
      motion_error_V({.time = {}, .T_W_I = truth[0], .T_V_I = from}, {.time = {}, .T_W_I = truth[1], .T_V_I = to});
  EXPECT_LT((error - pushed).norm(), 1e-12);
}

TEST(RelativeError, HasNoPairsOverMoreThanThePathNorBetweenSparseSamples) {
  const auto truth = straight(11);
  EXPECT_EQ(relative_error(pairs_of(truth, truth), 12.0).pairs, 0u);
  EXPECT_EQ(relative_error(pairs_of(truth, truth), 0.5).pairs, 0u);
  EXPECT_EQ(relative_error({}, 1.0).pairs, 0u);
}

}  // namespace
}  // namespace pllit
