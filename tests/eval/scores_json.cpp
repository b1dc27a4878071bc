#include "pllit/eval/scores_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "eval/paths.hpp"

namespace pllit {
namespace {

using namespace test;

TEST(ScoresAsJson, CarryTheKeysThatScriptsRelyOn) {
  const auto poses = wandering(300, 41);
  const auto scores = evaluate(trajectory_of(poses, 0.0, 0.1), trajectory_of(disturbed(poses, 0.1, 0.02, 42), 0.0, 0.1),
                               {.alignment = Alignment::yaw, .rpe_deltas_m = {5.0, 20.0}});
  ASSERT_TRUE(scores) << scores.error().message;
  const auto json = scores_json(*scores);
  EXPECT_EQ(json.at("matched"), 300);
  EXPECT_EQ(json.at("align"), "yaw");
  EXPECT_EQ(json.at("ape").at("rmse"), scores->ape.translation_m.rmse);
  EXPECT_EQ(json.at("ape").at("median"), scores->ape.translation_m.median);
  EXPECT_EQ(json.at("ape").at("max"), scores->ape.translation_m.max);
  ASSERT_EQ(json.at("rpe").size(), 2u);
  EXPECT_EQ(json.at("rpe")[1].at("delta_m"), 20.0);
  EXPECT_EQ(json.at("rpe")[1].at("rmse"), scores->rpe[1].rmse_m);
  EXPECT_EQ(json.at("rpe")[1].at("percent"), scores->rpe[1].percent);
  EXPECT_EQ(json.at("rpe")[1].at("yaw_deg"), scores->rpe[1].yaw_deg);
}

TEST(ScoresAsJson, SayNullWhereThePathIsTooShortForAFigure) {
  const Trajectory truth = trajectory_of(wandering(20, 43), 0.0, 0.1);
  const auto json = scores_json(evaluate(truth, truth, {.rpe_deltas_m = {500.0}}).value());
  EXPECT_EQ(json.at("rpe")[0].at("pairs"), 0);
  EXPECT_TRUE(json.at("rpe")[0].at("rmse").is_null());
  EXPECT_TRUE(json.at("rpe")[0].at("percent").is_null());
}

}  // namespace
}  // namespace pllit
