#include "pllit/map/sight_log.hpp"

#include <gtest/gtest.h>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

Camera camera() { return {.width = 320, .height = 256, .fx = 300.0, .fy = 300.0, .cx = 160.0, .cy = 128.0}; }

/// A wall at z = 4 m, and a box before it from 2 m on where `box` holds.
std::vector<Vector3f> points(Random& random, bool box) {
  std::vector<Vector3f> points_W;
  for (int i = 0; i < 12000; ++i) {
    const Vector3d ray(random.uniform(-0.55, 0.55), random.uniform(-0.45, 0.45), 1.0);
    const bool hits_box = box && std::abs(2.0 * ray.x()) < 0.2 && std::abs(2.0 * ray.y()) < 0.2;
    points_W.push_back(((hits_box ? 2.0 : 4.0) * ray).cast<float>());
  }
  return points_W;
}

const cv::Mat kImage(256, 320, CV_32FC1, cv::Scalar(42.0F));

Sight sight_at(Time time, const Vector3d& p_W, bool box) {
  Random random(7);
  return sight_of(time, SE3(p_W, SO3::Identity()), points(random, box), kImage, camera(), {});
}

TEST(LookAt, TellsSurfacesFromFreeSpaceAndFromWhatIsHidden) {
  using Kind = PointSight::Kind;
  const Sight sight = sight_at(Time{}, Vector3d::Zero(), true);
  const auto kind = [&](const Vector3d& p_W) { return look_at(sight, p_W, camera(), {}).kind; };
  EXPECT_EQ(kind({0.0, 0.0, 2.0}), Kind::surface);
  EXPECT_EQ(kind({0.0, 0.0, 1.2}), Kind::free);
  EXPECT_EQ(kind({0.0, 0.0, 4.0}), Kind::hidden);
  EXPECT_EQ(kind({1.0, 0.0, 2.0}), Kind::free);
  EXPECT_EQ(kind({1.0, 0.0, 4.0}), Kind::surface);
  EXPECT_EQ(kind({0.0, 0.0, -1.0}), Kind::unknown);
  EXPECT_EQ(kind({9.0, 0.0, 4.0}), Kind::unknown);
  EXPECT_EQ(look_at(sight, {1.0, 0.0, 2.0}, camera(), {}).behind, 42.0F);
}

TEST(SightLog, KnowsThatAPlaceWasFreeBeforeSomethingCame) {
  SightLog log(camera(), {});
  const Vector3d p_W(0.0, 0.0, 2.0);
  for (int i = 0; i < 10; ++i) log.add(sight_at(Time{std::chrono::seconds(i)}, {0.04 * i, 0.0, 0.0}, i > 6));
  EXPECT_LT(log.size(), 5u);  // only where the camera has moved
  SightLog wide(camera(), {.spacing_m = 0.01});
  for (int i = 0; i < 10; ++i) wide.add(sight_at(Time{std::chrono::seconds(i)}, {0.04 * i, 0.0, 0.0}, i > 6));
  EXPECT_TRUE(wide.evidence(p_W, Time{std::chrono::seconds(6)}).was_free());
  EXPECT_EQ(wide.evidence(p_W, Time{std::chrono::seconds(6)}).surface, 0);
  EXPECT_EQ(wide.evidence(p_W, Time{std::chrono::seconds(60)}).surface, 3);
  EXPECT_FALSE(wide.evidence({0.0, 0.0, 4.0}, Time{std::chrono::seconds(6)}).was_free());
}

TEST(SightLog, ForgetsTheOldest) {
  SightLog log(camera(), {.spacing_m = 0.01, .most = 5});
  for (int i = 0; i < 12; ++i) log.add(sight_at(Time{std::chrono::seconds(i)}, {0.04 * i, 0.0, 0.0}, false));
  EXPECT_EQ(log.size(), 5u);
}

}  // namespace
}  // namespace pllit
