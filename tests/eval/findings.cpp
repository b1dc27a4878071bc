#include "pllit/eval/findings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace pllit {
namespace {

using Json = nlohmann::ordered_json;

Time at(double seconds) { return Time(from_seconds(1'700'000'000.0 + seconds)); }

Json scene() {
  return Json::parse(R"({"start_s": 1700000000.0, "objects": [
    {"name": "kettle", "finding": true, "begins_s": 40.0, "centroid_W": [1.0, 2.0, 0.8], "first_seen_s": 50.0},
    {"name": "valve", "finding": true, "begins_s": 40.0, "centroid_W": [5.0, 2.0, 0.8], "first_seen_s": null},
    {"name": "radiator", "finding": false, "begins_s": 0.0, "centroid_W": [9.0, 2.0, 0.8], "first_seen_s": null}]})");
}

Anomaly alarm(std::uint32_t id, const Vector3d& p_W, double confirmed_s, int voxels = 10) {
  Anomaly anomaly{.id = id, .state = AnomalyState::confirmed};
  anomaly.position_W = p_W;
  anomaly.confirmed = at(confirmed_s);
  anomaly.voxels = voxels;
  return anomaly;
}

FindingScores scored(const std::vector<Anomaly>& anomalies, const SE3& T_W_V = SE3::Identity()) {
  return score_findings(anomalies, objects_of_scene(scene()).value(), T_W_V);
}

TEST(Findings, CountAnObjectAsFoundWhereAnAlarmLiesNearIt) {
  const FindingScores scores = scored({alarm(1, {1.03, 2.0, 0.84}, 50.6)});
  EXPECT_EQ(scores.objects, 1);  // the valve was never in sight
  EXPECT_EQ(scores.found, 1);
  EXPECT_EQ(scores.false_alarms, 0);
  EXPECT_NEAR(scores.position_m.at(0), 0.05, 1e-9);
  EXPECT_NEAR(scores.delay_s.at(0), 0.6, 1e-6);
}

TEST(Findings, CountAlarmsFarFromAllFindingsOnDistractorsOrTooEarlyAsFalse) {
  const FindingScores scores =
      scored({alarm(1, {9.0, 2.0, 0.8}, 50.0), alarm(2, {1.0, 2.0, 0.8}, 30.0), alarm(3, {1.0, 3.0, 0.8}, 60.0)});
  EXPECT_EQ(scores.found, 0);
  EXPECT_EQ(scores.false_alarms, 3);
}

TEST(Findings, LeaveOutWhatWasNeverConfirmed) {
  Anomaly fresh = alarm(1, {9.0, 2.0, 0.8}, 50.0);
  fresh.confirmed.reset();
  EXPECT_EQ(scored({fresh}).false_alarms, 0);
}

TEST(Findings, TakeTheLargestOfSeveralAlarmsForThePositionAndTheFirstForTheDelay) {
  const FindingScores scores = scored({alarm(1, {1.0, 2.2, 0.8}, 50.5, 4), alarm(2, {1.0, 2.01, 0.8}, 52.0, 40)});
  EXPECT_EQ(scores.found, 1);
  EXPECT_EQ(scores.duplicates, 1);
  EXPECT_NEAR(scores.position_m.at(0), 0.01, 1e-9);
  EXPECT_NEAR(scores.delay_s.at(0), 0.5, 1e-6);
}

TEST(Findings, AreComparedInTheWorldOfTheTruth) {
  const SE3 T_W_V(Vector3d(10.0, 0.0, 0.0), exp_so3({0.0, 0.0, 0.5}));
  EXPECT_NEAR(scored({alarm(1, T_W_V.inverse().act(Vector3d(1.0, 2.0, 0.8)), 51.0)}, T_W_V).position_m.at(0), 0.0,
              1e-9);
}

TEST(Findings, HaveTheKeysThatWerePromised) {
  const Json json = findings_json(scored({alarm(1, {1.03, 2.0, 0.84}, 50.6)}));
  EXPECT_EQ(json["objects"], 1);
  EXPECT_EQ(json["found"], 1);
  EXPECT_EQ(json["false_alarms"], 0);
  EXPECT_NEAR(json["position_m"]["median"].get<double>(), 0.05, 1e-9);
  EXPECT_NEAR(json["position_m"]["max"].get<double>(), 0.05, 1e-9);
  EXPECT_NEAR(json["delay_s"]["max"].get<double>(), 0.6, 1e-6);
  ASSERT_EQ(json["each"].size(), 1u);
  EXPECT_EQ(json["each"][0]["found"], true);
  EXPECT_NEAR(json["each"][0]["position_m"].get<double>(), 0.05, 1e-9);
  const Json nothing = findings_json(scored({}));
  EXPECT_TRUE(nothing["position_m"]["max"].is_null());
  EXPECT_EQ(nothing["each"][0]["found"], false);
  EXPECT_TRUE(nothing["each"][0]["delay_s"].is_null());
}

TEST(Findings, SayWhatASceneLacks) {
  Json broken = scene();
  broken["objects"][0].erase("centroid_W");
  const auto objects = objects_of_scene(broken);
  ASSERT_FALSE(objects);
  EXPECT_THAT(objects.error().message, testing::HasSubstr("centroid_W"));
}

}  // namespace
}  // namespace pllit
