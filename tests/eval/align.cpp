#include "pllit/eval/align.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/paths.hpp"

namespace pllit {
namespace {

using namespace test;
using ::testing::HasSubstr;

Vector3d mean_position(const std::vector<PosePair>& pairs, SE3 PosePair::* pose) {
  Vector3d sum = Vector3d::Zero();
  for (const PosePair& pair : pairs) sum += (pair.*pose).translation();
  return sum / static_cast<double>(pairs.size());
}

/// Sum of squared distances with rotation R_W_V and the translation that suits it best.
double cost_of(const std::vector<PosePair>& pairs, const SO3& R_W_V) {
  const Matrix3d R = R_W_V.rotation();
  const Vector3d mean_W = mean_position(pairs, &PosePair::T_W_I), mean_V = mean_position(pairs, &PosePair::T_V_I);
  double cost = 0.0;
  for (const PosePair& pair : pairs)
    cost += (pair.T_W_I.translation() - mean_W - R * (pair.T_V_I.translation() - mean_V)).squaredNorm();
  return cost;
}

/// Lowest cost that a blind search over rotations finds: random starts, then ever smaller random steps from the best.
double cost_by_search(const std::vector<PosePair>& pairs, bool yaw_only) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  SO3 best = SO3::Identity();
  double lowest = cost_of(pairs, best);
  for (double step = 2.0; step > 1e-5; step *= 0.8)
    for (int i = 0; i < 200; ++i) {
      Vector3d phi(normal(random), normal(random), normal(random));
      if (yaw_only) phi.head<2>().setZero();
      const SO3 candidate = best * exp_so3(step * phi);
      const double cost = cost_of(pairs, candidate);
      if (cost < lowest) {
        lowest = cost;
        best = candidate;
      }
    }
  return lowest;
}

TEST(Alignment, RecoversTheMotionOfANoiseFreeEstimate) {
  const auto truth = wandering(200, 1);
  const auto pairs = pairs_of(truth, seen_from(far_motion().inverse(), truth));
  const auto T_W_V = alignment_of(pairs, Alignment::se3);
  ASSERT_TRUE(T_W_V) << T_W_V.error().message;
  EXPECT_TRUE(T_W_V->isApprox(far_motion(), 1e-9));
}

TEST(Alignment, RecoversHeadingAndShiftWithYawOnly) {
  const SE3 T_W_V_true = pose_from(yaw(-160.0), Vector3d(3.0, 4.0, 5.0));
  const auto truth = wandering(200, 2);
  const auto T_W_V = alignment_of(pairs_of(truth, seen_from(T_W_V_true.inverse(), truth)), Alignment::yaw);
  ASSERT_TRUE(T_W_V) << T_W_V.error().message;
  EXPECT_TRUE(T_W_V->isApprox(T_W_V_true, 1e-9));
}

TEST(Alignment, CostsNoMoreThanABlindSearchOverAllRotations) {
  const auto truth = wandering(60, 3);
  const auto pairs = pairs_of(truth, seen_from(far_motion(), disturbed(truth, 0.5, 0.0, 4)));
  for (const Alignment alignment : {Alignment::se3, Alignment::yaw}) {
    const auto T_W_V = alignment_of(pairs, alignment);
    ASSERT_TRUE(T_W_V) << T_W_V.error().message;
    const double cost = cost_of(pairs, T_W_V->asSO3()), searched = cost_by_search(pairs, alignment == Alignment::yaw);
    EXPECT_LE(cost, searched * (1.0 + 1e-12));
    EXPECT_NEAR(searched / cost, 1.0, 1e-4) << "the search should have come as far";
    EXPECT_LT((mean_position(aligned(pairs, *T_W_V), &PosePair::T_V_I) - mean_position(pairs, &PosePair::T_W_I)).norm(),
              1e-9);
  }
}

TEST(Alignment, StaysARotationWhereAReflectionWouldFitBetter) {
  const auto truth = wandering(60, 5);
  std::vector<SE3> mirrored;
  for (const SE3& pose : truth) {
    const Vector3d p = pose.translation();
    mirrored.push_back(moved_to(p.x(), p.y(), -p.z()));
  }
  const auto pairs = pairs_of(truth, mirrored);
  const auto T_W_V = alignment_of(pairs, Alignment::se3);
  ASSERT_TRUE(T_W_V) << T_W_V.error().message;
  EXPECT_NEAR(T_W_V->rotation().determinant(), 1.0, 1e-9);
  const double cost = cost_of(pairs, T_W_V->asSO3());
  EXPECT_GT(cost, 1e-3) << "a rotation cannot undo a mirror";
  EXPECT_LE(cost, cost_by_search(pairs, false) * (1.0 + 1e-12));
}

TEST(Alignment, NeverChangesTheScale) {
  const auto truth = wandering(100, 6);
  std::vector<SE3> doubled;
  for (const SE3& pose : truth) doubled.push_back(pose_from(pose.asSO3(), 2.0 * pose.translation()));
  const auto pairs = pairs_of(truth, doubled);
  const auto moved = aligned(pairs, alignment_of(pairs, Alignment::se3).value());
  const double truth_m = (truth.back().translation() - truth.front().translation()).norm();
  EXPECT_NEAR((moved.back().T_V_I.translation() - moved.front().T_V_I.translation()).norm(), 2.0 * truth_m, 1e-9);
}

TEST(Alignment, LeavesEverythingWhereItIsWithNone) {
  const auto truth = straight(3);
  const auto pairs = pairs_of(truth, seen_from(moved_to(0.0, 2.0, 0.0), truth));
  const auto moved = aligned(pairs, alignment_of(pairs, Alignment::none).value());
  EXPECT_NEAR(moved[1].T_V_I.translation().y(), 2.0, 1e-12);
}

TEST(Alignment, RefusesPositionsOnOneLine) {
  const auto line = straight(50);
  const auto on_a_line = alignment_of(pairs_of(line, seen_from(far_motion(), line)), Alignment::se3);
  ASSERT_FALSE(on_a_line);
  EXPECT_EQ(on_a_line.error().kind, Error::Kind::input);
  EXPECT_THAT(on_a_line.error().message, HasSubstr("50 matched positions lie on one line"));
  EXPECT_TRUE(alignment_of(pairs_of(line, line), Alignment::yaw)) << "a level line determines the heading";
}

TEST(Alignment, RefusesTooFewPoses) {
  const std::vector<SE3> two{moved_to(0, 0, 0), moved_to(1, 2, 0)}, one{moved_to(0, 0, 0)};
  EXPECT_FALSE(alignment_of(pairs_of(two, two), Alignment::se3));
  EXPECT_TRUE(alignment_of(pairs_of(two, two), Alignment::yaw));
  EXPECT_FALSE(alignment_of(pairs_of(one, one), Alignment::yaw));
  EXPECT_TRUE(alignment_of(pairs_of(one, one), Alignment::none));
}

TEST(Alignment, RefusesAHeadingFromALift) {
  const std::vector<SE3> lift{moved_to(0, 0, 0), moved_to(0, 0, 5), moved_to(0, 0, 10)};
  const auto heading = alignment_of(pairs_of(lift, lift), Alignment::yaw);
  ASSERT_FALSE(heading);
  EXPECT_THAT(heading.error().message, HasSubstr("align with none"));
}

}  // namespace
}  // namespace pllit
