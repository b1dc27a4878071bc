#include "pllit/slam/drift.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>

#include "support/random_states.hpp"

namespace pllit {
namespace {

const Eigen::Matrix3Xd kNone(3, 0);

TEST(MapDrift, GrowsOnlyWithNewPartsOfTheMap) {
  test::Random random(61);
  MapDrift drift({});
  drift.place({.mean = random.state(), .covariance = random.covariance(0.01)}, kNone, false);
  drift.add_scan(0.0);
  EXPECT_EQ(drift.doubt().drift.norm(), 0.0);
  drift.add_scan(0.2);
  const Matrix6 once = drift.doubt().drift;
  drift.add_scan(0.2);
  EXPECT_LT((drift.doubt().drift - 2.0 * once).norm(), 1e-12);
}

TEST(MapDrift, TurnsAnErrorInHeadingIntoOneInPosition) {
  MapDrift drift({.shift_m = 0.0, .turn_rad = 0.0, .scale_share = 0.0});
  Estimate estimate;
  estimate.covariance(2, 2) = 1e-4;  // 0.01 rad about the vertical
  drift.place(estimate, kNone, false);
  drift.add_scan(1.0);
  drift.move_to(pose_from(SO3::Identity(), {10.0, 0.0, 0.0}));
  EXPECT_NEAR(std::sqrt(drift.doubt().drift(4, 4)), 0.1, 1e-9);  // across the way, not along it
  EXPECT_NEAR(drift.doubt().drift(3, 3), 0.0, 1e-12);
}

TEST(MapDrift, DoubtsTheScaleOfTheWholeWayAtOnce) {
  MapDrift drift({.shift_m = 0.0, .turn_rad = 0.0, .scale_share = 1e-3});
  drift.move_to(pose_from(SO3::Identity(), {50.0, 0.0, 0.0}));
  const PoseDoubt halfway = drift.doubt();
  drift.move_to(pose_from(SO3::Identity(), {100.0, 0.0, 0.0}));
  EXPECT_NEAR(std::sqrt(drift.doubt().total()(3, 3)), 0.1, 1e-9);
  EXPECT_NEAR(std::sqrt(relative_covariance(halfway, drift.doubt(), {50.0, 0.0, 0.0})(3, 3)), 0.05, 1e-9);
}

/// Sigma of the heading after a quarter turn on the way, each scan of which adds a share of new map.
double heading_sigma_rad(double new_share) {
  MapDrift drift({.shift_m = 0.0, .turn_rad = 0.0, .turn_share = 2e-3});
  for (int i = 0; i <= 90; ++i) {
    drift.move_to(pose_from(exp_so3({0.0, 0.0, i * std::numbers::pi / 180.0}), Vector3d::Zero()));
    drift.add_scan(new_share);
  }
  return std::sqrt(drift.doubt().total()(2, 2));
}

TEST(MapDrift, DoubtsTurnsIntoTheUnknownAndNotThoseInAKnownPlace) {
  EXPECT_NEAR(heading_sigma_rad(0.05), 2e-3 * 0.5 * std::numbers::pi, 1e-9);
  EXPECT_EQ(heading_sigma_rad(0.0), 0.0);
}

Estimate with_shift_variances(const Vector3d& variances_m2) {
  Estimate estimate;
  estimate.covariance.block<3, 3>(3, 3) = variances_m2.asDiagonal();
  return estimate;
}

TEST(MapDrift, CountsWhatWasNotPlacedAgainstTheMapFromWhereItWasPlacedLast) {
  MapDrift drift({.imu_factor = 1.5});
  const Eigen::Matrix3Xd along_x = Vector3d::UnitX();
  drift.place(with_shift_variances({1.0, 1e-4, 1e-4}), along_x, false);
  drift.add_scan(1.0);
  const PoseDoubt early = drift.doubt();
  drift.place(with_shift_variances({4.0, 1e-4, 1e-4}), along_x, false);
  EXPECT_NEAR(drift.doubt().total()(3, 3), 1.5 * 1.5 * 4.0, 1e-9);
  EXPECT_NEAR(relative_covariance(early, drift.doubt(), Vector3d::Zero())(3, 3), 1.5 * 1.5 * 3.0, 1e-9);
  EXPECT_LT(drift.doubt().total()(4, 4), 1e-3);
}

TEST(MapDrift, DoubtsTheDirectionInWhichItReckons) {
  MapDrift drift({});
  drift.place(with_shift_variances({1e4, 1e-4, 1e-4}), Vector3d::UnitX(), false);  // 100 m along it
  EXPECT_GT(std::sqrt(drift.doubt().total()(4, 4)), 0.3);
  EXPECT_LT(std::sqrt(drift.doubt().total()(4, 4)), 1.0);
}

TEST(MapDrift, BelievesAnImageThatLeadsWhereNoScanDoes) {
  MapDrift drift({.imu_factor = 1.5});
  drift.place(with_shift_variances({4.0, 1e-4, 1e-4}), Vector3d::UnitX(), true);
  EXPECT_NEAR(drift.doubt().total()(3, 3), 4.0, 1e-9);
}

TEST(MapDrift, KeepsWhatWasReckonedOnceScansPlaceItAgain) {
  MapDrift drift({.imu_factor = 1.0});
  drift.place(with_shift_variances({4.0, 1e-4, 1e-4}), Vector3d::UnitX(), false);
  for (const double falling_m2 : {1.0, 0.1, 1e-4}) {
    drift.place(with_shift_variances({falling_m2, 1e-4, 1e-4}), kNone, false);
    EXPECT_NEAR(drift.doubt().total()(3, 3), 4.0, 1e-9);
  }
  EXPECT_LT(drift.doubt().match(3, 3) + drift.doubt().reckoned(0, 0), 1e-3);
}

TEST(Carried, MatchesWhatARotationDoesToADistantPoint) {
  test::Random random(62);
  const Vector3d displacement = random.vector(5.0);
  const auto J = test::numerical_jacobian<3, 6>(
      [&](const Vector6& e) -> Vector3d { return exp_so3(e.head<3>()).act(displacement) + e.tail<3>(); });
  const Matrix6 P = random.covariance(0.1).topLeftCorner<6, 6>();
  const Matrix3d expected = J * P * J.transpose(), moved = carried(P, displacement).bottomRightCorner<3, 3>();
  EXPECT_LT((moved - expected).norm(), 1e-6);
}

}  // namespace
}  // namespace pllit
