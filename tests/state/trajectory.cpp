#include "pllit/state/trajectory.hpp"

#include <gtest/gtest.h>

namespace pllit {
namespace {

using namespace std::chrono_literals;

Trajectory turning_and_driving() {
  Trajectory trajectory;
  for (int i = 0; i < 5; ++i)
    trajectory.push_back({Time(i * 100ms), pose_from(exp_so3({0.0, 0.0, 0.2 * i}), {1.0 * i, 0.0, 0.0})});
  return trajectory;
}

TEST(PoseAt, InterpolatesAlongTheGeodesicAndTheLine) {
  const auto pose = pose_at(turning_and_driving(), Time(250ms), 1s);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation().x(), 2.5, 1e-12);
  EXPECT_NEAR(log_so3(pose->asSO3()).z(), 0.5, 1e-12);
}

TEST(PoseAt, ReturnsSamplesExactlyAndNothingOutside) {
  const Trajectory trajectory = turning_and_driving();
  EXPECT_EQ(pose_at(trajectory, Time(400ms), 1s)->translation().x(), 4.0);
  EXPECT_EQ(pose_at(trajectory, Time(0ms), 1s)->translation().x(), 0.0);
  EXPECT_FALSE(pose_at(trajectory, Time(-1ms), 1s));
  EXPECT_FALSE(pose_at(trajectory, Time(401ms), 1s));
  EXPECT_FALSE(pose_at({}, Time(0ms), 1s));
}

TEST(PoseAt, DoesNotBridgeAGap) { EXPECT_FALSE(pose_at(turning_and_driving(), Time(250ms), 99ms)); }

TEST(PathLength, SumsTheSteps) { EXPECT_DOUBLE_EQ(path_length_m(turning_and_driving()), 4.0); }

}  // namespace
}  // namespace pllit
