// Whole rigs in whole worlds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <set>

#include "pllit/sim/sequences.hpp"
#include "pllit/sim/simulation.hpp"

namespace pllit {
namespace {

struct Tally {
  int imu = 0, scans = 0, images = 0;
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a over all that was delivered
  std::vector<SensorEvent> events;

  template <class Value>
  void add(const Value* values, std::size_t count) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values);
    for (std::size_t i = 0; i < count * sizeof(Value); ++i) hash = (hash ^ bytes[i]) * 1099511628211u;
  }
};

Tally drained(Simulation& simulation) {
  Tally tally;
  while (auto event = simulation.next().value()) {
    tally.add(&event->received, 1);
    if (const auto* imu = std::get_if<ImuSample>(&event->data)) {
      ++tally.imu;
      tally.add(imu->accel_mps2.data(), 3);
    } else if (const auto* scan = std::get_if<LidarScan>(&event->data)) {
      ++tally.scans;
      tally.add(scan->points_L.data(), scan->points_L.size());
      tally.add(scan->rings.data(), scan->rings.size());
    } else {
      ++tally.images;
      const cv::Mat& counts = std::get<CameraFrame>(event->data).counts;
      tally.add(counts.data, counts.total() * counts.elemSize());
    }
    tally.events.push_back(std::move(*event));
  }
  return tally;
}

Tally made(const std::string& address) {
  auto simulation = open_simulation(address);
  EXPECT_TRUE(simulation) << simulation.error().message;
  return drained(*simulation);
}

TEST(SimulatedWorlds, DeliverTheirRigsSensorsInEveryScene) {
  for (const std::string scene : {"room", "corridor", "stairs", "plant", "street", "field"}) {
    const Tally tally = made("sim:" + scene + "?duration=3&image_rate=1&seed=2");
    EXPECT_GE(tally.imu, 600) << scene;
    EXPECT_EQ(tally.scans, 30) << scene;
    EXPECT_EQ(tally.images, 3) << scene;
    EXPECT_TRUE(std::ranges::is_sorted(tally.events, {}, &SensorEvent::received)) << scene;
    for (const SensorEvent& event : tally.events)
      if (const auto* scan = std::get_if<LidarScan>(&event.data)) {
        EXPECT_GT(scan->points_L.size(), 3000u) << scene;
        EXPECT_EQ(scan->rings.size(), scan->points_L.size());
        EXPECT_TRUE(std::ranges::is_sorted(scan->offsets));
      }
  }
}

TEST(SimulatedWorlds, AreTheSameBytesForTheSameSeedAndOthersForAnother) {
  const auto hash = [](const std::string& options) {
    return made("sim:plant?duration=3&image_rate=2&people=2&images=both&" + options).hash;
  };
  const auto first = hash("seed=5");
  EXPECT_EQ(first, hash("seed=5"));
  EXPECT_NE(first, hash("seed=6"));
}

TEST(SimulatedWorlds, BeginWithTwoSecondsOfExactRest) {
  auto simulation = open_simulation("sim:room?duration=4&images=none&seed=3");
  ASSERT_TRUE(simulation);
  const Trajectory truth = simulation->truth();
  for (const StampedPose& pose : truth) {
    if (pose.time - truth.front().time >= std::chrono::seconds(2)) break;
    ASSERT_EQ(pose.T_W_I.translation(), truth.front().T_W_I.translation());
  }
  EXPECT_GT((truth.back().T_W_I.translation() - truth.front().T_W_I.translation()).norm(), 0.1);
}

TEST(SimulatedWorlds, GiveOutAThermalCamerasCountsAndItsVideo) {
  const Tally tally = made("sim:plant?duration=3&image_rate=2&images=both&seed=4");
  int counts = 0, grey = 0;
  for (const SensorEvent& event : tally.events)
    if (const auto* frame = std::get_if<CameraFrame>(&event.data))
      (frame->counts.type() == CV_16UC1 ? counts : grey) += 1;
  EXPECT_EQ(counts, 6);
  EXPECT_EQ(grey, 6);
}

TEST(SimulatedWorlds, TellWhatIsToBeFoundAndWhenItCouldBeSeen) {
  auto simulation =
      open_simulation("sim:room?rig=inspection&finding=table&finding_at=3&duration=40&image_rate=0.7&seed=1");
  ASSERT_TRUE(simulation) << simulation.error().message;
  drained(*simulation);
  const SceneTruth truth = simulation->scene_truth();
  const auto findings = std::ranges::count_if(truth.objects, &SceneObject::finding);
  EXPECT_EQ(findings, 1);
  EXPECT_GT(truth.objects.size(), 1u) << "a cold object and a hot radiator are there to be left alone";
  const auto finding = std::ranges::find_if(truth.objects, &SceneObject::finding);
  EXPECT_TRUE(finding->arrival == "heated" || finding->arrival == "brought");
  ASSERT_TRUE(finding->first_seen_s);
  EXPECT_GE(*finding->first_seen_s, 3.0);
  EXPECT_LE(*finding->first_seen_s, 40.0);
  const auto json = scene_json(truth, "sim:...");
  EXPECT_EQ(json["objects"].size(), truth.objects.size());
  EXPECT_NE(json["T_I_C"]["known"], json["T_I_C"]["true"]);
}

TEST(SimulatedWorlds, HoldAsManyHotBoxesAsAreAskedForEachOfItsOwnKind) {
  const std::string place = "sim:plant?rig=inspection&images=none&scans=0&duration=3&finding_at=2&seed=2";
  auto with = open_simulation(place + "&finding=pipe&hot_boxes=6"), without = open_simulation(place + "&finding=pipe");
  ASSERT_TRUE(with && without);
  const auto objects = with->scene_truth().objects;
  EXPECT_EQ(std::ranges::count_if(objects, &SceneObject::finding), 7);
  std::set<std::string> names;
  std::set<double> sizes_m;
  for (const SceneObject& object : objects) {
    names.insert(object.name);
    if (!object.size_m) continue;
    sizes_m.insert(*object.size_m);
    EXPECT_TRUE(*object.size_m >= 0.1 && *object.size_m <= 0.5) << *object.size_m;
    EXPECT_TRUE(object.by_K >= 5.0 && object.by_K <= 40.0) << object.by_K;
    EXPECT_TRUE(object.begins_s >= 25.0 && object.begins_s <= 50.0) << object.begins_s;
  }
  EXPECT_EQ(names.size(), objects.size());
  EXPECT_EQ(sizes_m.size(), 6u);
  const auto alone = without->scene_truth().objects;
  EXPECT_EQ(alone.front().name, objects.front().name);
  EXPECT_EQ(alone.front().centroid_W, objects.front().centroid_W) << "the named finding stands where it would alone";
}

TEST(SimulatedWorlds, AreVisitedAgainOnAnotherWalk) {
  const std::string place =
      "sim:room?rig=inspection&finding=table&finding_at=0&seed=1&duration=3&images=counts&image_rate=1";
  auto first = open_simulation(place), again = open_simulation(place + "&visit=1"),
       warmer = open_simulation(place + "&visit=1&warmer_K=10");
  ASSERT_TRUE(first && again && warmer);
  EXPECT_EQ(first->rig().T_I_C.coeffs(), again->rig().T_I_C.coeffs()) << "the rig is the same one";
  const auto way_m = (first->truth().back().T_W_I.translation() - again->truth().back().T_W_I.translation()).norm();
  EXPECT_GT(way_m, 0.5);
  const auto before = first->scene_truth().objects, now = again->scene_truth().objects;
  ASSERT_EQ(before.size(), now.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    EXPECT_EQ(before[i].name, now[i].name);
    EXPECT_LT((before[i].centroid_W - now[i].centroid_W).norm(), 0.3) << "seen from elsewhere";
  }
  const auto first_image = [](Simulation& simulation) {
    const Tally tally = drained(simulation);
    for (const SensorEvent& event : tally.events)
      if (const auto* frame = std::get_if<CameraFrame>(&event.data)) return cv::mean(frame->counts)[0];
    return 0.0;
  };
  EXPECT_GT(first_image(*warmer), first_image(*again) + 50.0);
}

TEST(SimulatedWorlds, AreFurnishedAlikeWhetherAFindingHasBegunOrIsYetToCome) {
  for (const std::string row : {"room?finding=table", "plant?finding=pipe"}) {
    const std::string place = "sim:" + row + "&rig=inspection&images=none&seed=3";
    auto before = open_simulation(place + "&finding_at=3000"), after = open_simulation(place + "&finding_at=0&visit=1");
    ASSERT_TRUE(before && after);
    const auto then = before->scene_truth().objects, now = after->scene_truth().objects;
    ASSERT_EQ(then.size(), now.size());
    for (std::size_t i = 0; i < now.size(); ++i)
      EXPECT_LT((then[i].centroid_W - now[i].centroid_W).norm(), 0.3) << row << ": " << now[i].name;
  }
}

TEST(SimulatedWorlds, AreKnownExactlyOnlyWhereTheyAreIdeal) {
  auto ideal = open_simulation("sim:room?duration=3&ideal=1&images=none");
  ASSERT_TRUE(ideal);
  const SceneTruth truth = ideal->scene_truth();
  EXPECT_EQ(truth.T_I_C.coeffs(), truth.T_I_C_known.coeffs());
  EXPECT_EQ(truth.lidar_clock, Duration{0});
  EXPECT_EQ(truth.imu.gyro_density, 0.0);
}

TEST(SimulatedWorlds, NeedTheFileOfAMotionToBeRead) {
  const auto config = parse_sim_config("sim:room?motion=walk.tum");
  ASSERT_TRUE(config);
  EXPECT_FALSE(Simulation::make(*config));
}

}  // namespace
}  // namespace pllit
