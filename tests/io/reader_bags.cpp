#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "pllit/io/bag_reader.hpp"
#include "support/bag_fixtures.hpp"

namespace pllit {
namespace {

using namespace std::chrono_literals;
using test::sample_events;
using test::TemporaryFolder;
using test::write_bag;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<SensorEvent> all_events(BagSource& source) {
  std::vector<SensorEvent> events;
  while (true) {
    auto event = source.next();
    EXPECT_TRUE(event) << (event ? "" : event.error().message);
    if (!event || !*event) return events;
    events.push_back(std::move(**event));
  }
}

Time stamp_of(const SensorEvent& event) {
  if (const auto* imu = std::get_if<ImuSample>(&event.data)) return imu->time;
  if (const auto* scan = std::get_if<LidarScan>(&event.data)) return scan->start;
  return std::get<CameraFrame>(event.data).time;
}

void expect_same(const std::vector<SensorEvent>& read, const std::vector<SensorEvent>& written) {
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].received, written[i].received) << i;
    ASSERT_EQ(read[i].data.index(), written[i].data.index()) << i;
    EXPECT_EQ(stamp_of(read[i]), stamp_of(written[i])) << i;
    const auto* scan = std::get_if<LidarScan>(&read[i].data);
    if (scan == nullptr) continue;
    EXPECT_EQ(scan->points_L, std::get<LidarScan>(written[i].data).points_L);
    EXPECT_EQ(scan->intensity, std::get<LidarScan>(written[i].data).intensity);
    EXPECT_EQ(scan->offsets.size(), std::get<LidarScan>(written[i].data).offsets.size());
  }
}

TEST(BagReading, ReturnsWhatWasWrittenInTheOrderReceived) {
  const TemporaryFolder folder;
  const auto events = sample_events({});
  write_bag(folder / "a.bag", events);
  auto source = open_bags({folder / "a.bag"});
  ASSERT_TRUE(source) << source.error().message;
  expect_same(all_events(**source), events);
  EXPECT_EQ((*source)->topics().imu, "/imu");
  EXPECT_EQ((*source)->topics().lidar, "/points");
  EXPECT_EQ((*source)->topics().image, "/thermal/image");
  EXPECT_THAT((*source)->notes(), IsEmpty());
  ASSERT_TRUE((*source)->time_layout());
  EXPECT_EQ((*source)->time_layout()->unit, TimeUnit::seconds);
}

TEST(BagReading, ProgressAscendsFromZeroToOne) {
  const TemporaryFolder folder;
  write_bag(folder / "a.bag", sample_events({}));
  auto source = open_bags({folder / "a.bag"});
  ASSERT_TRUE(source) << source.error().message;
  double last = (*source)->progress();
  EXPECT_EQ(last, 0.0);
  while (*(*source)->next()) {
    EXPECT_GE((*source)->progress(), last);
    last = (*source)->progress();
  }
  EXPECT_EQ(last, 1.0);
}

TEST(BagReading, MergesBagsGivenInAnyOrderWhetherOneFollowsTheOtherOrRunsBesideIt) {
  const TemporaryFolder folder;
  const auto events = sample_events({});
  std::vector<SensorEvent> early, late, imu, others;
  for (const SensorEvent& event : events) {
    (event.received < events[events.size() / 2].received ? early : late).push_back(event);
    (std::holds_alternative<ImuSample>(event.data) ? imu : others).push_back(event);
  }
  write_bag(folder / "0.bag", early);
  write_bag(folder / "1.bag", late);
  write_bag(folder / "imu.bag", imu);
  write_bag(folder / "others.bag", others);
  for (const auto& paths :
       {std::vector{folder / "1.bag", folder / "0.bag"}, {folder / "imu.bag", folder / "others.bag"}}) {
    auto source = open_bags(paths);
    ASSERT_TRUE(source) << source.error().message;
    const auto read = all_events(**source);
    ASSERT_EQ(read.size(), events.size());
    EXPECT_TRUE(std::ranges::is_sorted(read, {}, &SensorEvent::received));
  }
}

TEST(BagReading, PutsMessagesOfABagThatWasNotWrittenInTimeOrderIntoOrder) {
  const TemporaryFolder folder;
  auto events = sample_events({.duration_s = 20.0});
  std::ranges::stable_sort(events, {}, [](const SensorEvent& event) { return event.data.index(); });
  write_bag(folder / "by_topic.bag", events);
  auto source = open_bags({folder / "by_topic.bag"});
  ASSERT_TRUE(source) << source.error().message;
  const auto read = all_events(**source);
  EXPECT_EQ(read.size(), events.size());
  EXPECT_TRUE(std::ranges::is_sorted(read, {}, &SensorEvent::received));
  EXPECT_THAT((*source)->notes(), IsEmpty());
}

TEST(BagReading, LeavesImagesOutOnRequestAndNotesTheirAbsence) {
  const TemporaryFolder folder;
  write_bag(folder / "a.bag", sample_events({}));
  write_bag(folder / "b.bag", sample_events({.with_images = false}));
  auto without = open_bags({folder / "a.bag"}, {.with_images = false});
  ASSERT_TRUE(without) << without.error().message;
  for (const SensorEvent& event : all_events(**without)) EXPECT_FALSE(std::holds_alternative<CameraFrame>(event.data));
  auto absent = open_bags({folder / "b.bag"});
  ASSERT_TRUE(absent) << absent.error().message;
  EXPECT_THAT((*absent)->notes(), Contains(HasSubstr("no image topic")));
}

TEST(BagReading, SkipsAndCountsMessagesThatCannotBeDecoded) {
  const TemporaryFolder folder;
  auto writer = BagWriter::create(folder / "a.bag");
  ASSERT_TRUE(writer);
  const LidarScan scan{Time(1000s), {{1, 2, 3}}, {0ns}, {1}};
  ASSERT_TRUE(writer->write_scan("/points", scan.start, scan));
  const std::vector<std::byte> rubbish(40, std::byte{0x5a});
  for (int i = 0; i < 30; ++i) {
    const Time time = Time(1000s) + i * 10ms;
    const auto written =
        i % 3 == 0 ? writer->write("/imu", kImuType, time, rubbish) : writer->write_imu("/imu", time, {time, {}, {}});
    ASSERT_TRUE(written) << written.error().message;
  }
  ASSERT_TRUE(writer->close());
  auto source = open_bags({folder / "a.bag"});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ(all_events(**source).size(), 21u);
  EXPECT_THAT((*source)->notes(),
              Contains(AllOf(HasSubstr("/imu: 10 of 30 messages skipped"), HasSubstr("cut short"))));
}

TEST(BagReading, GivesUpOnATopicWhoseFirstTwentyMessagesAreAllBad) {
  const TemporaryFolder folder;
  auto writer = BagWriter::create(folder / "a.bag");
  ASSERT_TRUE(writer);
  const std::vector<std::byte> rubbish(40, std::byte{0x5a});
  for (int i = 0; i < 30; ++i) {
    const Time time = Time(1000s) + i * 10ms;
    ASSERT_TRUE(writer->write_imu("/imu", time, {time, {}, {}}));
    ASSERT_TRUE(writer->write("/points", kPointCloud2Type, time, rubbish));
  }
  ASSERT_TRUE(writer->close());
  auto source = open_bags({folder / "a.bag"});
  ASSERT_TRUE(source) << source.error().message;
  std::size_t good = 0;
  auto event = (*source)->next();
  for (; event && *event; event = (*source)->next()) ++good;
  ASSERT_FALSE(event);
  EXPECT_EQ(good, 20u);
  EXPECT_EQ(event.error().kind, Error::Kind::input);
  EXPECT_THAT(event.error().message,
              AllOf(HasSubstr("/points"), HasSubstr("PointCloud2 message of 40 bytes is cut short")));
}

TEST(BagReading, UsesTheTimeReceivedWhereHeadersHaveNoStamp) {
  const TemporaryFolder folder;
  auto writer = BagWriter::create(folder / "a.bag");
  ASSERT_TRUE(writer);
  const Time received(1000s);
  ASSERT_TRUE(writer->write_imu("/imu", received, {Time{}, {}, {}}));
  ASSERT_TRUE(writer->write_scan("/points", received, {Time{}, {{1, 2, 3}, {4, 5, 6}}, {0ns, 100ms}, {1, 1}}));
  ASSERT_TRUE(writer->close());
  auto source = open_bags({folder / "a.bag"});
  ASSERT_TRUE(source) << source.error().message;
  const auto events = all_events(**source);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(stamp_of(events[0]), received);
  EXPECT_NEAR(to_seconds(received - stamp_of(events[1])), 0.1, 1e-8);
  EXPECT_THAT((*source)->notes(), Contains(HasSubstr("2 messages have no header stamp")));
}

TEST(BagReading, RemembersTheUnitSoThatAShortScanIsReadLikeTheOthers) {
  const TemporaryFolder folder;
  auto writer = BagWriter::create(folder / "a.bag");
  ASSERT_TRUE(writer);
  const PointCloud2Layout microseconds{.time_unit = TimeUnit::microseconds};
  const Time start(1000s);
  ASSERT_TRUE(writer->write_imu("/imu", start, {start, {}, {}}));
  for (const Duration sweep : {Duration(100ms), Duration(400us)}) {
    ASSERT_TRUE(
        writer->write_scan("/points", start, {start, {{1, 2, 3}, {4, 5, 6}}, {0ns, sweep}, {1, 1}}, microseconds));
  }
  ASSERT_TRUE(writer->close());
  auto source = open_bags({folder / "a.bag"});
  ASSERT_TRUE(source) << source.error().message;
  const auto events = all_events(**source);
  ASSERT_EQ(events.size(), 3u);
  EXPECT_EQ(std::get<LidarScan>(events[2].data).offsets.back(), 400us);
}

TEST(BagWriting, ReportsAFullDiskAndAFolderThatIsNotThere) {
  EXPECT_FALSE(BagWriter::create("/nonexistent_folder/a.bag"));
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  auto writer = BagWriter::create("/dev/full");
  Expected<void> last;
  for (int i = 0; writer && i < 100'000 && last; ++i) last = writer->write_imu("/imu", Time(1000s), {});
  if (writer && last) last = writer->close();
  ASSERT_FALSE(writer && last);
  const Error error = writer ? last.error() : writer.error();
  EXPECT_EQ(error.kind, Error::Kind::failure);
  EXPECT_THAT(error.message, HasSubstr("No space left"));
}

}  // namespace
}  // namespace pllit
