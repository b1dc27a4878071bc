#include "pllit/eval/evaluate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/paths.hpp"
#include "pllit/io/tum.hpp"
#include "support/recordings.hpp"

namespace pllit {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Lt;

TEST(Evaluation, FindsNothingWrongWithTheTruthItself) {
  const Trajectory truth = trajectory_of(wandering(300, 31), 1.3e9, 0.1);
  const auto scores = evaluate(truth, truth, {.rpe_deltas_m = {1.0, 10.0}});
  ASSERT_TRUE(scores) << scores.error().message;
  EXPECT_EQ(scores->matched, truth.size());
  EXPECT_NEAR(scores->length_m, path_length_m(truth), 1e-9);
  EXPECT_NEAR(scores->ape.translation_m.max, 0.0, 1e-9);
  ASSERT_EQ(scores->rpe.size(), 2u);
  EXPECT_NEAR(scores->rpe[1].percent, 0.0, 1e-7);
}

TEST(Evaluation, ReportsTheMotionBetweenTheTwoWorlds) {
  const auto poses = wandering(300, 32);
  const auto scores = evaluate(trajectory_of(poses, 5.0, 0.1), trajectory_of(seen_from(far_motion(), poses), 5.0, 0.1));
  ASSERT_TRUE(scores) << scores.error().message;
  EXPECT_TRUE(scores->T_W_V.isApprox(far_motion().inverse(), 1e-8));
}

TEST(Evaluation, RefusesADistanceThatIsNotPositive) {
  const Trajectory truth = trajectory_of(wandering(10, 33), 0.0, 0.1);
  for (const double delta_m : {0.0, -1.0, std::nan("")}) {
    const auto scores = evaluate(truth, truth, {.rpe_deltas_m = {delta_m}});
    ASSERT_FALSE(scores);
    EXPECT_THAT(scores.error().message, HasSubstr("must be positive"));
  }
}

TEST(Evaluation, FindsTheDocumentedDisagreementOfTheKittiReferences) {
  PLLIT_RECORDING(kiss_path, "kitti_0005/kitti_0005.kiss.tum");
  PLLIT_RECORDING(velocity_path, "kitti_0005/kitti_0005.velocity.tum");
  PLLIT_RECORDING(gps_path, "kitti_0005/kitti_0005.gps.tum");
  const Trajectory kiss = read_tum(kiss_path).value(), velocity = read_tum(velocity_path).value(),
                   gps = read_tum(gps_path).value();
  EXPECT_NEAR(path_length_m(kiss), 72.2, 0.1);
  EXPECT_NEAR(path_length_m(velocity), 71.6, 0.1);
  EXPECT_NEAR(path_length_m(gps), 69.4, 0.1);
  for (const auto& [truth, estimate] : {std::pair{kiss, velocity}, std::pair{kiss, gps}, std::pair{velocity, gps}}) {
    const auto scores = evaluate(truth, estimate, {.rpe_deltas_m = {10.0}});
    ASSERT_TRUE(scores) << scores.error().message;
    EXPECT_GE(scores->matched, 152u);
    EXPECT_THAT(scores->rpe[0].percent, AllOf(Ge(3.0), Lt(6.5)));
    EXPECT_GT(scores->rpe[0].pairs, 100u);
  }
}

}  // namespace
}  // namespace pllit
