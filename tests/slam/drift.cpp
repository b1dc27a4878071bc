#include "pllit/slam/drift.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/random_states.hpp"

namespace pllit {
namespace {

const Eigen::Matrix3Xd kNone(3, 0);

TEST(MapDrift, GrowsOnlyWithNewPartsOfTheMap) {
  test::Random random(61);
  const Estimate estimate{.mean = random.state(), .covariance = random.covariance(0.01)};
  MapDrift drift({});
  drift.add_scan(estimate, 0.0, kNone);
  EXPECT_EQ(drift.covariance_W().norm(), 0.0);
  drift.add_scan(estimate, 0.2, kNone);
  const Matrix6 once = drift.covariance_W();
  drift.add_scan(estimate, 0.2, kNone);
  EXPECT_LT((drift.covariance_W() - 2.0 * once).norm(), 1e-12);
}

TEST(MapDrift, TurnsAnErrorInHeadingIntoOneInPosition) {
  MapDrift drift({.gain = 1.0, .shift_m = 0.0, .turn_rad = 0.0});
  Estimate estimate;
  estimate.covariance(2, 2) = 1e-4;  // 0.01 rad about the vertical
  drift.add_scan(estimate, 1.0, kNone);
  drift.move_to({10.0, 0.0, 0.0});
  EXPECT_NEAR(std::sqrt(drift.covariance_W()(4, 4)), 0.1, 1e-9);  // across the way, not along it
  EXPECT_NEAR(drift.covariance_W()(3, 3), 0.0, 1e-12);
}

TEST(MapDrift, LeavesToTheFilterWhatWasNotPlacedAgainstTheMap) {
  MapDrift drift({});
  Estimate estimate;
  estimate.covariance.block<3, 3>(3, 3) = Vector3d(4.0, 1e-4, 1e-4).asDiagonal();
  drift.add_scan(estimate, 1.0, Eigen::Matrix3Xd(Vector3d::UnitX()));
  EXPECT_EQ(drift.covariance_W()(3, 3), 0.0);
  EXPECT_NEAR(drift.covariance_W()(4, 4), 1e-4, 1e-12);
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
