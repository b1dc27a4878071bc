#include "pllit/sim/motion/fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pllit/io/tum.hpp"
#include "pllit/sim/random.hpp"
#include "sim/motion/checks.hpp"
#include "support/recordings.hpp"

namespace pllit {
namespace {

using testing::HasSubstr;

constexpr double kDeg = std::numbers::pi / 180.0;

/// Poses at 10 Hz that sway along y by a sine.
Trajectory swaying(double frequency_hz, double amplitude_m) {
  Trajectory path;
  for (int i = 0; i <= 600; ++i)
    path.push_back(
        {Time{} + std::chrono::milliseconds(100 * i),
         pose_from(SO3::Identity(),
                   {0.1 * i, amplitude_m * std::sin(2.0 * std::numbers::pi * frequency_hz * 0.1 * i), 0.0})});
  return path;
}

double sway_m(const Motion& motion) {
  double squares = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double y = motion.at(motion.start() + std::chrono::seconds(10) + std::chrono::milliseconds(10 * i))
                         .T_W_I.translation()
                         .y();
    squares += y * y / 4000.0;
  }
  return std::sqrt(2.0 * squares);
}

TEST(FitMotion, PassesWhatIsSlowerThanItsCutoffAndStopsWhatIsFaster) {
  for (const double ratio : {0.25, 0.5, 1.0, 1.5, 2.0}) {
    const auto fitted = fit_motion(swaying(1.5 * ratio, 0.1), {.cutoff_hz = 1.5, .spacing_s = 0.1});
    ASSERT_TRUE(fitted);
    EXPECT_NEAR(sway_m(fitted->motion) / 0.1, 1.0 / (1.0 + std::pow(ratio, 6)), 0.06) << ratio;
  }
}

TEST(FitMotion, FollowsAPathThatIsSmoothAlready) {
  const auto fitted = fit_motion(test::winding_path(60.0), kHandHeldFit);
  ASSERT_TRUE(fitted);
  EXPECT_LT(fitted->distance.position_max_m, 2e-3);
  EXPECT_LT(fitted->distance.rotation_max_rad, 0.02 * kDeg);
  test::expect_exact_derivatives(fitted->motion);
}

TEST(FitMotion, FollowsRotationsThroughAllDirections) {
  Trajectory path;
  SO3 R = SO3::Identity();
  for (int i = 0; i < 600; ++i) {
    path.push_back({Time{} + std::chrono::milliseconds(100 * i), pose_from(R, Vector3d::Zero())});
    R = R * exp_so3(0.15 * Vector3d(std::sin(0.02 * i), std::cos(0.03 * i), std::sin(0.05 * i)));
  }
  const auto fitted = fit_motion(path, kHandHeldFit);
  ASSERT_TRUE(fitted);
  EXPECT_LT(fitted->distance.rotation_max_rad, 0.1 * kDeg);
}

TEST(FitMotion, StatesTheDistanceToThePath) {
  Trajectory path = test::winding_path(20.0);
  Random random(3);
  for (StampedPose& pose : path)
    pose.T_W_I = pose_from(pose.T_W_I.asSO3() * exp_so3(0.01 * random.gaussian3()),
                           pose.T_W_I.translation() + 0.05 * random.gaussian3());
  const auto fitted = fit_motion(path, {.cutoff_hz = 0.3, .spacing_s = 0.2});
  ASSERT_TRUE(fitted);
  double squares = 0.0, largest_m = 0.0;
  for (const StampedPose& pose : path) {
    const double d_m = (fitted->motion.at(pose.time).T_W_I.translation() - pose.T_W_I.translation()).norm();
    squares += d_m * d_m;
    largest_m = std::max(largest_m, d_m);
  }
  EXPECT_NEAR(fitted->distance.position_rms_m, std::sqrt(squares / static_cast<double>(path.size())), 1e-12);
  EXPECT_EQ(fitted->distance.position_max_m, largest_m);
  EXPECT_NEAR(fitted->distance.position_rms_m, 0.05 * std::sqrt(3.0), 0.01);
  EXPECT_NEAR(fitted->distance.rotation_rms_rad, 0.01 * std::sqrt(3.0), 0.002);
}

TEST(FitMotion, BridgesShortGapsSmoothly) {
  const Trajectory whole = test::winding_path(40.0);
  Trajectory gappy;
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (i < 150 || i > 165) gappy.push_back(whole[i]);
  const auto fitted = fit_motion(gappy, kHandHeldFit);
  ASSERT_TRUE(fitted);
  for (const StampedPose& pose : whole)
    EXPECT_LT((fitted->motion.at(pose.time).T_W_I.translation() - pose.T_W_I.translation()).norm(), 0.05);
}

TEST(FitMotion, RefusesPathsItCannotFollow) {
  const Trajectory good = test::winding_path(20.0);
  const auto message = [](const Trajectory& path) {
    const auto fitted = fit_motion(path, kHandHeldFit);
    if (fitted) return std::string("no error");
    EXPECT_EQ(fitted.error().kind, Error::Kind::input);
    return fitted.error().message;
  };
  EXPECT_THAT(message({}), HasSubstr("0 poses"));
  EXPECT_THAT(message({good.begin(), good.begin() + 3}), HasSubstr("too short"));

  Trajectory twice = good;
  twice[50].time = twice[49].time;
  EXPECT_THAT(message(twice), HasSubstr("pose 50 of the path is not later"));

  Trajectory gap = good;
  for (std::size_t i = 70; i < gap.size(); ++i) gap[i].time += std::chrono::seconds(5);
  EXPECT_THAT(message(gap), HasSubstr("gap of 5.1 s before pose 70"));

  Trajectory leap = good;
  leap[30].T_W_I = pose_from(leap[30].T_W_I.asSO3() * exp_so3({0.0, 0.0, 2.5}), leap[30].T_W_I.translation());
  EXPECT_THAT(message(leap), HasSubstr("at pose 30"));

  Trajectory broken = good;
  broken[12].T_W_I = pose_from(broken[12].T_W_I.asSO3(), {0.0, std::nan(""), 0.0});
  EXPECT_THAT(message(broken), HasSubstr("pose 12 of the path is not finite"));
}

TEST(FitMotion, GivesTheSameBytesTwice) {
  const auto first = fit_motion(test::winding_path(20.0), kCarFit),
             second = fit_motion(test::winding_path(20.0), kCarFit);
  for (Time t = first->motion.start(); t < first->motion.end(); t += std::chrono::milliseconds(171))
    ASSERT_EQ(first->motion.at(t).T_W_I.coeffs(), second->motion.at(t).T_W_I.coeffs());
}

TEST(MotionAlong, StartsAtRestAndReachesTheFirstSpeedGently) {
  const auto fitted = motion_along(test::winding_path(60.0), kCarFit);  // 5 m/s from the first pose on
  ASSERT_TRUE(fitted);
  test::expect_exact_rest(fitted->motion, 2.0);
  EXPECT_LT(test::magnitudes(fitted->motion).acceleration_mps2.back(), 2.7);
}

class RecordedDrive : public testing::TestWithParam<const char*> {};

TEST_P(RecordedDrive, IsFollowedCloselyAtAccelerationsThatTyresHold) {
  PLLIT_RECORDING(path, std::string("trajectories/") + GetParam());
  const auto fitted = motion_along(*read_tum(path), kCarFit);
  ASSERT_TRUE(fitted) << fitted.error().message;
  EXPECT_LT(fitted->distance.position_rms_m, 0.05);
  EXPECT_LT(fitted->distance.position_max_m, 0.5);
  EXPECT_LT(fitted->distance.rotation_rms_rad, 0.5 * kDeg);
  EXPECT_LT(fitted->distance.rotation_max_rad, 4.0 * kDeg);
  const test::Magnitudes all = test::magnitudes(fitted->motion);
  EXPECT_LT(all.percentile_99(all.acceleration_mps2), 4.0);
  test::expect_exact_rest(fitted->motion, 2.0);
  test::expect_exact_derivatives(fitted->motion);
}
INSTANTIATE_TEST_SUITE_P(Kitti, RecordedDrive, testing::Values("kitti_00.tum", "kitti_07.tum"));

TEST_P(RecordedDrive, CanBeFasterByTwoFifthsWhereItIsStraight) {
  PLLIT_RECORDING(path, std::string("trajectories/") + GetParam());
  const Trajectory drive = *read_tum(path);
  const auto faster = sped_up_within(drive, 1.4, 3.0, kCarFit);
  ASSERT_TRUE(faster) << faster.error().message;
  const double ratio =
      to_seconds(drive.back().time - drive.front().time) / to_seconds(faster->back().time - faster->front().time);
  EXPECT_GT(ratio, 1.15);
  EXPECT_LT(ratio, 1.4);
  const auto fitted = motion_along(*faster, kCarFit);
  ASSERT_TRUE(fitted) << fitted.error().message;
  const test::Magnitudes all = test::magnitudes(fitted->motion);
  EXPECT_LT(all.percentile_99(all.acceleration_mps2), 4.0);
}

class RecordedWalk : public testing::TestWithParam<const char*> {};

TEST_P(RecordedWalk, IsFollowedCloselyWithItsSteps) {
  PLLIT_RECORDING(path, std::string("trajectories/") + GetParam());
  const auto fitted = motion_along(*read_tum(path), kHandHeldFit);
  ASSERT_TRUE(fitted) << fitted.error().message;
  EXPECT_LT(fitted->distance.position_rms_m, 0.003);
  EXPECT_LT(fitted->distance.position_max_m, 0.02);
  EXPECT_LT(fitted->distance.rotation_rms_rad, 0.6 * kDeg);
  EXPECT_LT(fitted->distance.rotation_max_rad, 3.0 * kDeg);
  const test::Magnitudes all = test::magnitudes(fitted->motion);
  EXPECT_GT(all.percentile_99(all.acceleration_mps2), 1.5);  // a walk without steps has less
  EXPECT_LT(all.acceleration_mps2.back(), 6.0);
}
INSTANTIATE_TEST_SUITE_P(Hilti, RecordedWalk, testing::Values("hilti2022_exp04.tum", "hilti2022_exp05.tum"));

}  // namespace
}  // namespace pllit
