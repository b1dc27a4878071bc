#include "pllit/sim/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace pllit {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string error_of(std::string_view source) {
  const auto config = parse_sim_config(source);
  if (config) return "no error";
  EXPECT_EQ(config.error().kind, Error::Kind::input);
  return config.error().message;
}

TEST(SimulationText, HasDefaultsForEverythingButTheScene) {
  const auto config = parse_sim_config("sim:box_corridor");
  ASSERT_TRUE(config);
  EXPECT_EQ(config->scene, SceneKind::box_corridor);
  EXPECT_EQ(config->seed, 1u);
  EXPECT_FALSE(config->duration_s);
  EXPECT_FALSE(config->ideal);
  EXPECT_FALSE(config->faults.imu_gap.contains(0.0));
}

TEST(SimulationText, SetsEveryKey) {
  const auto config = parse_sim_config(
      "sim:box_street?seed=18446744073709551615&duration=12.5&imu_rate=400&speed=1.5&motion=shake&lidar=ring16&ideal=1"
      "&accel_unit=g&imu_gap=3:3.5&lidar_gap=4:5&time_back=6:7&duplicates=7:8&imu_nan=8:8.1&late_scans=9:10"
      "&swapped_imu=10:11");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->scene, SceneKind::box_street);
  EXPECT_EQ(config->seed, 18446744073709551615u);
  EXPECT_EQ(config->duration_s, 12.5);
  EXPECT_EQ(config->imu_rate_hz, 400.0);
  EXPECT_EQ(config->speed_mps, 1.5);
  EXPECT_EQ(config->carried, SimConfig::Carried::shake);
  EXPECT_EQ(config->box_lidar, SimConfig::BoxLidar::ring16);
  EXPECT_TRUE(config->ideal);
  EXPECT_TRUE(config->accel_in_g);
  EXPECT_EQ(config->faults.imu_gap.from_s, 3.0);
  EXPECT_EQ(config->faults.imu_gap.to_s, 3.5);
  EXPECT_EQ(config->faults.lidar_gap.from_s, 4.0);
  EXPECT_EQ(config->faults.time_back.from_s, 6.0);
  EXPECT_EQ(config->faults.duplicates.from_s, 7.0);
  EXPECT_EQ(config->faults.imu_nan.to_s, 8.1);
  EXPECT_EQ(config->faults.late_scans.from_s, 9.0);
  EXPECT_EQ(config->faults.swapped_imu.from_s, 10.0);
}

TEST(SimulationText, ListsTheScenesWhereOneIsUnknown) {
  for (const auto* source : {"sim:rom", "sim:", "sim:?seed=1", "sim:Room"})
    EXPECT_THAT(error_of(source), AllOf(HasSubstr(source), HasSubstr("did you mean"),
                                        HasSubstr("room, corridor, stairs, plant, street, field")));
}

TEST(SimulationText, ListsTheKeysWhereOneIsUnknownOrRepeated) {
  EXPECT_THAT(error_of("sim:box_room?sede=3"), AllOf(HasSubstr("\"sede\""), HasSubstr("did you mean seed"),
                                                     HasSubstr("seed, duration, ideal, motion, lidar")));
  EXPECT_THAT(error_of("sim:box_room?seed=3&seed=4"), AllOf(HasSubstr("\"seed\""), HasSubstr("twice")));
}

TEST(SimulationText, SaysWhatAWrongValueShouldBe) {
  EXPECT_THAT(error_of("sim:box_room?duration=2"), HasSubstr("seconds from 3 to 36000"));
  EXPECT_THAT(error_of("sim:box_room?duration=nan"), HasSubstr("seconds from 3 to 36000"));
  EXPECT_THAT(error_of("sim:box_room?duration=30s"), HasSubstr("duration=30s"));
  EXPECT_THAT(error_of("sim:box_room?imu_rate=2000"), HasSubstr("Hz from 10 to 1000"));
  EXPECT_THAT(error_of("sim:box_room?speed="), HasSubstr("m/s from 0.1 to 3"));
  EXPECT_THAT(error_of("sim:box_room?seed=-1"), HasSubstr("whole number"));
  EXPECT_THAT(error_of("sim:box_room?seed=1.5"), HasSubstr("whole number"));
  EXPECT_THAT(error_of("sim:box_room?lidar=xt32"), HasSubstr("ring32 or ring16"));
  EXPECT_THAT(error_of("sim:box_room?accel_unit=G"), HasSubstr("mps2 or g"));
  for (const auto* interval : {"5", "5:", ":5", "6:5", "5:5", "-1:5", "1:inf", "a:b", "1:2:3"})
    EXPECT_THAT(error_of(std::string("sim:box_room?imu_gap=") + interval), HasSubstr("FROM:TO")) << interval;
}

TEST(SimulationText, SetsTheKeysOfWorlds) {
  const auto config = parse_sim_config(
      "sim:plant?rig=inspection&motion=walk.tum&speedup=1.4&way=mirrored&length=80&imu=bmi088&image_rate=25&images="
      "both&light=night"
      "&people=3&finding=pipe&arrival=brought&finding_at=20&finding_K=12&lost_share=0.1&clock_drift=20&late_by=0.2&"
      "image_gap=1:2&hot_boxes=4&air_drift=-20");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->rig, SimConfig::RigName::inspection);
  EXPECT_EQ(config->motion, "walk.tum");
  EXPECT_EQ(config->way, SimConfig::Way::mirrored);
  EXPECT_EQ(config->length_m, 80.0);
  EXPECT_EQ(config->images, SimConfig::Images::both);
  EXPECT_FALSE(config->day);
  EXPECT_EQ(config->people, 3);
  EXPECT_EQ(config->finding, SimConfig::Finding::pipe);
  EXPECT_EQ(config->arrival, SimConfig::Arrival::brought);
  EXPECT_EQ(config->finding_K, 12.0);
  EXPECT_EQ(config->hot_boxes, 4);
  EXPECT_EQ(config->air_drift_Kph, -20.0);
  EXPECT_EQ(config->faults.lost_share, 0.1);
  EXPECT_EQ(config->faults.late_by_s, 0.2);
}

TEST(SimulationText, RefusesWhatDoesNotGoTogetherAndSaysWhy) {
  EXPECT_THAT(error_of("sim:room?lidar=ring16"), AllOf(HasSubstr("does not go with room"), HasSubstr("rig")));
  EXPECT_THAT(error_of("sim:box_room?rig=hilti2022"), HasSubstr("does not go with box_room"));
  EXPECT_THAT(error_of("sim:street?finding=pipe"), HasSubstr("need a room or a plant"));
  EXPECT_THAT(error_of("sim:field?hot_boxes=2"), HasSubstr("need a room or a plant"));
  EXPECT_THAT(error_of("sim:room?cars=2"), HasSubstr("needs a street"));
  EXPECT_THAT(error_of("sim:room?bare=1"), HasSubstr("needs a corridor"));
  EXPECT_THAT(error_of("sim:room?way=mirrored"), HasSubstr("needs motion=FILE"));
  EXPECT_THAT(error_of("sim:street?visit=1"), HasSubstr("needs a room or a plant"));
  EXPECT_THAT(error_of("sim:room?visit=1&motion=walk.tum"), HasSubstr("no motion=FILE"));
  EXPECT_THAT(error_of("sim:plant?finding=pipe&finding_at=50&duration=40"), HasSubstr("lies beyond"));
}

TEST(SimulationText, RefusesWhatIsNotKeyEqualsValue) {
  EXPECT_THAT(error_of("sim:box_room?seed"), HasSubstr("key=value"));
  EXPECT_THAT(error_of("sim:box_room?=1"), HasSubstr("\"\" is unknown"));
  EXPECT_THAT(error_of("sim:box_room?seed=1&"), HasSubstr("key=value"));
  EXPECT_THAT(error_of("room"), HasSubstr("must start with sim:"));
}

}  // namespace
}  // namespace pllit
