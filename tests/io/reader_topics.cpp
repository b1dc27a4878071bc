#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "pllit/io/bag_description.hpp"
#include "pllit/io/bag_reader.hpp"
#include "support/bag_fixtures.hpp"

namespace pllit {
namespace {

using namespace std::chrono_literals;
using test::sample_events;
using test::SampleRecording;
using test::TemporaryFolder;
using test::write_bag;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

std::string error_of(const std::vector<std::filesystem::path>& paths, const BagOptions& options = {}) {
  const auto source = open_bags(paths, options);
  if (source) return "";
  EXPECT_EQ(source.error().kind, Error::Kind::input);
  return source.error().message;
}

TEST(BagReading, AsksWhichTopicIsMeantWhereSeveralFit) {
  const TemporaryFolder folder;
  auto writer = BagWriter::create(folder / "a.bag");
  ASSERT_TRUE(writer);
  for (int i = 0; i < 20; ++i) {
    const Time time = Time(1000s) + i * 10ms;
    ASSERT_TRUE(writer->write_imu("/camera/imu", time, {time, {}, {}}));
    ASSERT_TRUE(writer->write_imu("/vectornav/imu", time, {time, {}, {}}));
    ASSERT_TRUE(writer->write_imu("/vectornav/imu", time, {time, {}, {}}));
    const LidarScan scan{time, {{1, 2, 3}}, {0ns}, {1}};
    ASSERT_TRUE(writer->write_scan("/map", time, scan));
    ASSERT_TRUE(writer->write_livox_scan("/livox/lidar", time, scan));
    const CameraFrame frame{time, cv::Mat(2, 2, CV_8UC1, cv::Scalar(1))};
    ASSERT_TRUE(writer->write_image("/rgb_cam/image_raw", time, frame));
    ASSERT_TRUE(writer->write_image("/thermal_cam/thermal_image", time, frame));
  }
  ASSERT_TRUE(writer->close());
  const auto bag = folder / "a.bag";
  EXPECT_THAT(error_of({bag}),
              AllOf(HasSubstr("2 topics could be the IMU"), HasSubstr("--set input.imu_topic=/vectornav/imu"),
                    HasSubstr("/livox/lidar  livox_ros_driver/CustomMsg  20 messages  100.0 Hz")));
  const BagOptions imu{.imu_topic = "/vectornav/imu"};
  EXPECT_THAT(error_of({bag}, imu), HasSubstr("--set input.lidar_topic=/livox/lidar"));
  BagOptions lidar = imu;
  lidar.lidar_topic = "/livox/lidar";
  EXPECT_THAT(error_of({bag}, lidar), HasSubstr("--set input.image_topic=/thermal_cam/thermal_image"));
  lidar.image_topic = "/thermal_cam/thermal_image";
  auto source = open_bags({bag}, lidar);
  ASSERT_TRUE(source) << source.error().message;
  std::size_t events = 0;
  while (*(*source)->next()) ++events;
  EXPECT_EQ(events, 80u);
}

TEST(BagReading, NamesTheNearestTopicAndTheTypeThatIsNeeded) {
  const TemporaryFolder folder;
  const auto bag = folder / "a.bag";
  write_bag(bag, sample_events({}));
  EXPECT_THAT(
      error_of({bag}, {.lidar_topic = "/point"}),
      AllOf(HasSubstr("no topic '/point'"), HasSubstr("--set input.lidar_topic=/points"), HasSubstr("200 messages")));
  EXPECT_THAT(error_of({bag}, {.imu_topic = "/points"}),
              AllOf(HasSubstr("'/points' is a sensor_msgs/PointCloud2, but the IMU needs sensor_msgs/Imu"),
                    HasSubstr("--set input.imu_topic=/imu")));
}

TEST(BagReading, ListsWhatIsThereWhereASensorIsMissing) {
  const TemporaryFolder folder;
  auto events = sample_events({});
  std::erase_if(events, [](const SensorEvent& event) { return std::holds_alternative<LidarScan>(event.data); });
  write_bag(folder / "a.bag", events);
  EXPECT_THAT(error_of({folder / "a.bag"}),
              AllOf(HasSubstr("no LiDAR topic: sensor_msgs/PointCloud2 or Livox CustomMsg"),
                    HasSubstr("/imu  sensor_msgs/Imu  200 messages  100.")));
}

TEST(BagReading, SaysPlainlyWhatIsWrongWithAFile) {
  const TemporaryFolder folder;
  test::write_contents(folder / "empty.bag", {});
  test::write_contents(folder / "text.bag", {'h', 'e', 'l', 'l', 'o'});
  const std::string sqlite = "SQLite format 3 and more";
  test::write_contents(folder / "ros2.db3", {sqlite.begin(), sqlite.end()});
  const std::string version_1 = "#ROSRECORD V1.2\n";
  test::write_contents(folder / "old.bag", {version_1.begin(), version_1.end()});
  const std::string bare = "#ROSBAG V2.0\n";
  test::write_contents(folder / "bare.bag", {bare.begin(), bare.end()});
  write_bag(folder / "good.bag", sample_events({}));
  EXPECT_THAT(error_of({folder / "absent.bag"}), HasSubstr("does not exist"));
  EXPECT_THAT(error_of({folder / "."}), HasSubstr("is a folder"));
  EXPECT_THAT(error_of({folder / "empty.bag"}), HasSubstr("is empty"));
  EXPECT_THAT(error_of({folder / "text.bag"}), HasSubstr("not a ROS 1 bag"));
  EXPECT_THAT(error_of({folder / "ros2.db3"}), HasSubstr("ROS 2"));
  EXPECT_THAT(error_of({folder / "old.bag"}), HasSubstr("before 2.0"));
  EXPECT_THAT(error_of({folder / "bare.bag"}), HasSubstr("no messages that can be read"));
  EXPECT_THAT(error_of({folder / "good.bag", folder / "." / "good.bag"}), HasSubstr("given twice"));
  EXPECT_THAT(error_of({}), HasSubstr("no bag"));
}

TEST(BagDescribing, ListsTopicsWithCountsRatesAndTimes) {
  const TemporaryFolder folder;
  const SampleRecording recording;
  write_bag(folder / "a.bag", sample_events(recording));
  const auto description = describe_bags({folder / "a.bag"});
  ASSERT_TRUE(description) << description.error().message;
  ASSERT_EQ(description->topics.size(), 3u);
  const TopicInfo& imu = description->topics[0];
  EXPECT_EQ(imu.name, "/imu");
  EXPECT_EQ(imu.type, "sensor_msgs/Imu");
  EXPECT_EQ(imu.count, 200u);
  EXPECT_EQ(imu.first, recording.start + 5ms);
  EXPECT_EQ(imu.last, recording.start + 1995ms);
  EXPECT_NEAR(imu.rate_hz(), 100.0, 1e-9);
  EXPECT_EQ(imu.bag, folder / "a.bag");
  EXPECT_NEAR(description->topics[1].rate_hz(), 10.0, 1e-9);
  EXPECT_THAT(description->notes, IsEmpty());
}

}  // namespace
}  // namespace pllit
