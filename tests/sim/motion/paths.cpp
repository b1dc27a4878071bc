#include "pllit/sim/motion/paths.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "pllit/sim/motion/fit.hpp"
#include "sim/motion/checks.hpp"

namespace pllit {
namespace {

/// Cosine of the angle between x of I and the way, at its worst.
double worst_alignment(const Trajectory& path) {
  const Motion motion = fit_motion(path, kHandHeldFit)->motion;
  double worst = 1.0;
  for (Time t = motion.start(); t < motion.end(); t += std::chrono::milliseconds(50)) {
    const MotionState state = motion.at(t);
    worst = std::min(worst, state.T_W_I.asSO3().act(Vector3d::UnitX()).dot(state.v_W.normalized()));
  }
  return worst;
}

void expect_rigid(const Trajectory& path) {
  for (const StampedPose& pose : path) {
    const Matrix3d R = pose.T_W_I.rotation();
    ASSERT_NEAR(R.determinant(), 1.0, 1e-12);
    ASSERT_LT((R * R.transpose() - Matrix3d::Identity()).norm(), 1e-12);
  }
}

TEST(SpedUp, KeepsThePosesAndShortensTheTime) {
  const Trajectory path = test::winding_path(28.0), fast = sped_up(path, 1.4);
  ASSERT_EQ(fast.size(), path.size());
  EXPECT_EQ(fast.front().time, path.front().time);
  EXPECT_EQ(fast.back().time - fast.front().time, std::chrono::seconds(20));
  EXPECT_EQ(fast[100].T_W_I.coeffs(), path[100].T_W_I.coeffs());
}

TEST(Mirrored, ExchangesLeftAndRightAndStillGoesForwards) {
  const Trajectory path = test::winding_path(30.0), other = mirrored(path);
  expect_rigid(other);
  EXPECT_GT(worst_alignment(other), 0.99);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vector3d p_W = path[i].T_W_I.translation();
    ASSERT_EQ(other[i].T_W_I.translation(), Vector3d(p_W.x(), -p_W.y(), p_W.z()));
    const Matrix3d S = Vector3d(1.0, -1.0, 1.0).asDiagonal();
    ASSERT_LT((other[i].T_W_I.rotation() - S * path[i].T_W_I.rotation() * S).norm(), 1e-12);
  }
}

TEST(Mirrored, TwiceIsThePathItself) {
  const Trajectory path = test::winding_path(10.0), twice = mirrored(mirrored(path));
  for (std::size_t i = 0; i < path.size(); ++i)
    ASSERT_LT((path[i].T_W_I.transform() - twice[i].T_W_I.transform()).norm(), 1e-12);
}

TEST(Reversed, GoesForwardsTheOtherWay) {
  const Trajectory path = test::winding_path(30.0), back = reversed(path);
  expect_rigid(back);
  EXPECT_GT(worst_alignment(back), 0.99);
  EXPECT_EQ(back.front().T_W_I.translation(), path.back().T_W_I.translation());
  EXPECT_EQ(back.back().T_W_I.translation(), path.front().T_W_I.translation());
  EXPECT_EQ(back.front().time, path.front().time);
  EXPECT_EQ(back.back().time, path.back().time);
  for (std::size_t i = 0; i < path.size(); ++i)  // upright stays upright
    ASSERT_NEAR(back[i].T_W_I.rotation()(2, 2), path[path.size() - 1 - i].T_W_I.rotation()(2, 2), 1e-12);
}

TEST(Cut, EndsAtTheDurationOrLengthAskedFor) {
  const Trajectory path = test::winding_path(30.0);
  const Trajectory brief = cut_to_duration(path, 12.34);
  EXPECT_EQ(brief.back().time - brief.front().time, std::chrono::milliseconds(12300));
  const Trajectory little = cut_to_length(path, 40.0);
  EXPECT_LE(path_length_m(little), 40.0);
  EXPECT_GT(path_length_m(little), 39.4);
  EXPECT_EQ(cut_to_duration(path, 100.0).size(), path.size());
  EXPECT_EQ(cut_to_length(path, 1e6).size(), path.size());
  EXPECT_TRUE(cut_to_length({}, 10.0).empty());
}

TEST(Ground, HasTheSlopeThatDifferencesShowAndTheStatedRelief) {
  double squares = 0.0, steepest = 0.0;
  const double h = 1e-4;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Ground ground({.seed = seed, .relief_m = 3.0});
    for (double x = -1000.0; x < 1000.0; x += 97.0)
      for (double y = -1000.0; y < 1000.0; y += 89.0) {
        const double dx = (ground.height_m({x + h, y}) - ground.height_m({x - h, y})) / (2.0 * h);
        const double dy = (ground.height_m({x, y + h}) - ground.height_m({x, y - h})) / (2.0 * h);
        ASSERT_LT((ground.slope({x, y}) - Eigen::Vector2d(dx, dy)).norm(), 1e-7);
        squares += ground.height_m({x, y}) * ground.height_m({x, y});
        steepest = std::max(steepest, ground.slope({x, y}).norm());
        ++count;
      }
  }
  EXPECT_NEAR(std::sqrt(squares / count), 3.0, 0.3);
  EXPECT_LT(steepest, 0.35);
}

TEST(OnGround, PutsTheRigAboveTheGroundAlongItsSlope) {
  const Ground ground({.seed = 4});
  const Trajectory path = on_ground(test::winding_path(60.0), ground, 1.7, Stance::tilted);
  expect_rigid(path);
  EXPECT_GT(worst_alignment(path), 0.99);
  for (const StampedPose& pose : path) {
    const Eigen::Vector2d position = pose.T_W_I.translation().head<2>();
    const Eigen::Vector2d slope = ground.slope(position);
    ASSERT_NEAR(pose.T_W_I.translation().z() - ground.height_m(position), 1.7, 1e-9);
    ASSERT_LT((pose.T_W_I.rotation().col(2) - Vector3d(-slope.x(), -slope.y(), 1.0).normalized()).norm(), 1e-9);
  }
}

TEST(OnGround, LeavesAPersonUpright) {
  const Trajectory path = test::winding_path(10.0);
  const Trajectory above = on_ground(path, Ground({.seed = 5}), 1.3, Stance::upright);
  for (std::size_t i = 0; i < path.size(); ++i)
    ASSERT_EQ(above[i].T_W_I.coeffs().tail<4>(), path[i].T_W_I.coeffs().tail<4>());
}

}  // namespace
}  // namespace pllit
