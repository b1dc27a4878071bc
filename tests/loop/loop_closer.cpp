#include "pllit/loop/loop_closer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "support/street_drive.hpp"

namespace pllit {
namespace {

/// The keyframes' poses turned away about the vertical, steadily.
std::vector<LoopKeyframe> turned_away(std::vector<LoopKeyframe> keyframes, double deg_per_m) {
  SE3 before = keyframes.front().T_O_I;
  for (std::size_t k = 1; k < keyframes.size(); ++k) {
    const SE3 step = before.inverse() * keyframes[k].T_O_I;
    before = keyframes[k].T_O_I;
    const double turn_rad = deg_per_m * M_PI / 180.0 * (keyframes[k].way_m - keyframes[k - 1].way_m);
    keyframes[k].T_O_I =
        keyframes[k - 1].T_O_I * step * pose_from(exp_so3(turn_rad * keyframes[k].up_I), Vector3d::Zero());
  }
  return keyframes;
}

/// Root mean square of the positions' errors; all poses start alike.
double error_m(const std::vector<LoopKeyframe>& truth, const std::vector<SE3>& poses) {
  double sum = 0.0;
  for (std::size_t k = 0; k < poses.size(); ++k)
    sum += (poses[k].translation() - truth[k].T_O_I.translation()).squaredNorm();
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

std::vector<SE3> odometry_of(const std::vector<LoopKeyframe>& keyframes) {
  std::vector<SE3> poses;
  for (const LoopKeyframe& keyframe : keyframes) poses.push_back(keyframe.T_O_I);
  return poses;
}

LoopCloser closed(const std::vector<LoopKeyframe>& keyframes, const LoopConfig& config = {}) {
  LoopCloser closer(config);
  for (const LoopKeyframe& keyframe : keyframes) closer.add(keyframe);
  closer.finish();
  return closer;
}

const std::vector<LoopKeyframe>& drive() {
  static const std::vector<LoopKeyframe> keyframes = test::up_and_back(SimConfig::RigName::hilti2022, 102);
  return keyframes;
}

double worst_accepted_m(const std::vector<LoopKeyframe>& truth, const LoopCloser& closer) {
  double worst = 0.0;
  for (const LoopRecord& record : closer.records()) {
    if (!record.accepted) continue;
    const SE3 T = truth[static_cast<std::size_t>(record.earlier)].T_O_I.inverse() *
                  truth[static_cast<std::size_t>(record.later)].T_O_I;
    worst = std::max(worst, difference(T, record.T_earlier_later).tail<3>().norm());
  }
  return worst;
}

TEST(LoopCloser, BringsADriftingDriveBackToTheTruth) {
  for (const double deg_per_m : {0.002, 0.02}) {
    const auto drifting = turned_away(drive(), deg_per_m);
    const LoopCloser closer = closed(drifting);
    EXPECT_GT(closer.accepted(), 5);
    EXPECT_LT(worst_accepted_m(drive(), closer), 0.3);
    EXPECT_LT(error_m(drive(), closer.poses_M()), std::max(0.1, error_m(drive(), odometry_of(drifting)) / 3.0));
  }
}

TEST(LoopCloser, LeavesAnExactDriveAsItIs) {
  const LoopCloser closer = closed(drive());
  EXPECT_GT(closer.accepted(), 5);
  EXPECT_LT(error_m(drive(), closer.poses_M()), 0.05);
}

TEST(LoopCloser, DoesNotBendTheStartWhereTheVerticalWasNotYetKnown) {
  // The odometry's frame is tilted, which it learns on the first metres: its verticals say so from there on.
  constexpr double kTilt_rad = 0.045, kDegree = M_PI / 180.0;
  auto tilted = drive();
  for (std::size_t k = 0; k < tilted.size(); ++k) {
    tilted[k].T_O_I = pose_from(exp_so3({0.0, kTilt_rad, 0.0}), Vector3d::Zero()) * tilted[k].T_O_I;
    if (k < 8) tilted[k].up_I = tilted[k].T_O_I.rotation().transpose() * Vector3d::UnitZ();
  }
  const LoopCloser closer = closed(tilted);
  EXPECT_GT(closer.accepted(), 5);
  const std::size_t later = 40;
  const SE3 expected = tilted[0].T_O_I.inverse() * tilted[later].T_O_I,
            found = closer.poses_M()[0].inverse() * closer.poses_M()[later];
  EXPECT_LT(difference(expected, found).head<3>().norm(), 0.3 * kDegree);
  const Vector3d up_M = closer.poses_M()[later].rotation() * tilted[later].up_I;
  EXPECT_LT(std::acos(up_M.z()), 0.3 * kDegree);
}

TEST(LoopCloser, GivesTheSameBytesForTheSameKeyframes) {
  const auto drifting = turned_away(drive(), 0.01);
  const LoopCloser a = closed(drifting), b = closed(drifting);
  ASSERT_EQ(a.poses_M().size(), b.poses_M().size());
  for (std::size_t k = 0; k < a.poses_M().size(); ++k) EXPECT_EQ(a.poses_M()[k].coeffs(), b.poses_M()[k].coeffs()) << k;
}

TEST(LoopCloser, TellsOfEveryCandidateWhatBecameOfIt) {
  LoopConfig strict;
  strict.registration.min_overlap = 1.01;
  const LoopCloser closer = closed(drive(), strict);
  EXPECT_EQ(closer.accepted(), 0);
  ASSERT_FALSE(closer.records().empty());
  for (const LoopRecord& record : closer.records())
    EXPECT_THAT(record.reason, testing::AnyOf(testing::StartsWith("overlap "), testing::StartsWith("the places")));
  EXPECT_EQ(closer.poses_M().size(), closer.keyframes().size());
}

TEST(LoopCloser, TakesNoKeyframesOrOne) {
  EXPECT_EQ(closed({}).accepted(), 0);
  EXPECT_EQ(closed({drive().front()}).poses_M().size(), 1u);
}

/// A loop between two keyframes as the true poses have it, its error added on the right.
LoopRecord loop_between(int earlier, int later, const Vector3d& error_m) {
  LoopRecord record{.earlier = earlier, .later = later};
  record.T_earlier_later = drive()[static_cast<std::size_t>(earlier)].T_O_I.inverse() *
                           drive()[static_cast<std::size_t>(later)].T_O_I * pose_from(SO3::Identity(), error_m);
  record.covariance = Matrix6::Identity() * 1e-6;
  record.covariance.bottomRightCorner<3, 3>() = 0.05 * 0.05 * Matrix3d::Identity();
  return record;
}

TEST(Consistency, LoopsThatAreRightAgreeAndOneThatIsNotStandsAlone) {
  const auto drifting = turned_away(drive(), 0.02);
  OdometryChain odometry;
  for (const LoopKeyframe& keyframe : drifting) odometry.append(keyframe.T_O_I, keyframe.step_covariance * 25.0);
  const std::vector<LoopRecord> loops{
      loop_between(5, 75, Vector3d::Zero()), loop_between(7, 77, Vector3d(0.03, 0.0, 0.0)),
      loop_between(9, 79, Vector3d(1.5, 0.0, 0.0)), loop_between(11, 81, Vector3d::Zero())};
  EXPECT_THAT(agreeing_set(loops, 0, odometry, 1.0, 16.8), testing::UnorderedElementsAre(0u, 1u, 3u));
  EXPECT_THAT(agreeing_set(loops, 2, odometry, 1.0, 16.8), testing::ElementsAre(2u));
}

TEST(UncertainMotion, CovariancesMatchErrorsThatAreDrawn) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto motion = [&](double angle) {
    UncertainMotion m{pose_from(exp_so3(Vector3d(0.2, -0.1, angle)), Vector3d(2.0, angle, 0.5)), Matrix6::Zero()};
    m.covariance.diagonal() << 1e-6, 4e-6, 9e-6, 1e-4, 2e-4, 3e-4;
    return m;
  };
  const UncertainMotion a = motion(0.7), b = motion(-0.4), chain = a * inverse(b);
  const auto drawn = [&](const UncertainMotion& m) {
    Vector6 e;
    for (int i = 0; i < 6; ++i) e[i] = std::sqrt(m.covariance(i, i)) * normal(random);
    return m.T_a_b * pose_from(exp_so3(e.head<3>()), e.tail<3>());
  };
  Matrix6 sampled = Matrix6::Zero();
  constexpr int draws = 20000;
  for (int i = 0; i < draws; ++i) {
    const Vector6 e = difference(chain.T_a_b, drawn(a) * drawn(b).inverse());
    sampled += e * e.transpose() / draws;
  }
  EXPECT_LT((sampled - chain.covariance).norm(), 0.05 * chain.covariance.norm());
}

TEST(OdometryChain, GivesTheErrorBetweenAnyTwoPosesAsSteppingWould) {
  OdometryChain chain;
  UncertainMotion stepped;
  for (std::size_t k = 0; k < 60; ++k) {
    chain.append(drive()[k].T_O_I, drive()[k].step_covariance);
    if (k == 20) stepped = {SE3::Identity(), Matrix6::Zero()};
    if (k > 20)
      stepped =
          stepped * UncertainMotion{drive()[k - 1].T_O_I.inverse() * drive()[k].T_O_I, drive()[k].step_covariance};
  }
  EXPECT_LT(difference(chain.between(20, 59).T_a_b, stepped.T_a_b).norm(), 1e-9);
  EXPECT_LT((chain.between(20, 59).covariance - stepped.covariance).norm(), 1e-9 * stepped.covariance.norm());
  EXPECT_LT(difference(chain.between(59, 20).T_a_b, stepped.T_a_b.inverse()).norm(), 1e-9);
}

}  // namespace
}  // namespace pllit
