#include "pllit/slam/relocalisation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/walled_site.hpp"

namespace pllit {
namespace {

using test::Random;

/// A walk through it at breast height.
VisitMap visit(unsigned seed, unsigned noise_seed, double from_y) {
  Random noise(noise_seed);
  VisitMap visit{.trajectory = {}, .points_W = test::walled_site(seed, noise)};
  for (int i = 0; i <= 100; ++i)
    visit.trajectory.push_back(
        {Time(std::chrono::milliseconds(100 * i)), pose_from(SO3::Identity(), Vector3d(-10.0 + 0.2 * i, from_y, 1.5))});
  return visit;
}

VisitMap moved(VisitMap visit, const SE3& T) {
  for (StampedPose& pose : visit.trajectory) pose.T_W_I = T * pose.T_W_I;
  for (Vector3f& p : visit.points_W) p = T.act(p.cast<double>()).cast<float>();
  return visit;
}

TEST(Relocalise, FindsASecondVisitThatBeganElsewhereAndTurnedAway) {
  const VisitMap first = visit(1, 10, 0.0);
  for (const double yaw : {0.4, 2.2, -2.9}) {
    const SE3 T_B_A = pose_from(exp_so3(Vector3d(0.0, 0.0, yaw)), Vector3d(13.0, -7.0, 0.8));
    const auto found = relocalise(first, moved(visit(1, 11, 2.0), T_B_A));
    ASSERT_TRUE(found) << found.error().message;
    const SE3 error = found->T_A_B * T_B_A;
    EXPECT_LT(error.translation().norm(), 0.05) << yaw;
    EXPECT_LT(log_so3(error.asSO3()).norm(), 0.005) << yaw;
    EXPECT_GE(found->agreeing, 2);
    EXPECT_LE(found->agreeing, found->places) << "a place counts once, however many of the first visit it fits";
  }
}

TEST(Relocalise, RefusesAnotherSite) {
  const auto found = relocalise(visit(1, 10, 0.0), visit(2, 12, 0.0));
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, Error::Kind::input);
  EXPECT_THAT(found.error().message, testing::HasSubstr("share no place"));
}

TEST(Relocalise, RefusesAnEmptyVisit) { EXPECT_FALSE(relocalise(visit(1, 10, 0.0), {})); }

}  // namespace
}  // namespace pllit
