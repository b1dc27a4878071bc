// Our bag reader and writer against rosbag, the format's own implementation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <map>
#include <random>
#include <tuple>

#include "pllit/io/bag_description.hpp"
#include "pllit/io/bag_merger.hpp"
#include "support/bag_fixtures.hpp"
#include "support/recordings.hpp"
#include "support/rosbag_bytes.hpp"

namespace pllit {
namespace {

using test::TemporaryFolder;

using Row = std::tuple<std::int64_t, std::string, std::vector<std::uint8_t>>;  // received, topic, bytes

std::vector<Row> rows_of_rosbag(const std::filesystem::path& path) {
  std::vector<Row> rows;
  rosbag::Bag bag(path.string());
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    rows.emplace_back(static_cast<std::int64_t>(message.getTime().toNSec()), message.getTopic(),
                      test::bytes_of(message));
  }
  return rows;
}

std::vector<Row> rows_of_ours(const std::filesystem::path& path) {
  auto files = bag::open_files({path});
  EXPECT_TRUE(files) << files.error().message;
  std::vector<std::set<std::uint32_t>> all(1);
  for (const auto& [id, connection] : files->front().connections()) all[0].insert(id);
  bag::BagMerger merger(std::move(*files), all);
  std::vector<Row> rows;
  while (const auto message = merger.next()) {
    const auto* data = reinterpret_cast<const std::uint8_t*>(message->bytes.data());
    rows.emplace_back(nanoseconds_of(message->received), merger.files()[0].connections().at(message->connection).topic,
                      std::vector(data, data + message->bytes.size()));
  }
  EXPECT_THAT(merger.notes(), testing::IsEmpty());
  return rows;
}

void expect_same_rows(std::vector<Row> ours, std::vector<Row> theirs) {
  ASSERT_EQ(ours.size(), theirs.size());
  EXPECT_TRUE(std::ranges::is_sorted(ours, {}, [](const Row& row) { return std::get<0>(row); }));
  std::ranges::sort(ours);  // messages received at the same time have no order
  std::ranges::sort(theirs);
  EXPECT_TRUE(ours == theirs);
}

TEST(BagTwin, RosbagReadsWhatWeWrite) {
  const TemporaryFolder folder;
  const auto events = test::sample_events({.duration_s = 20.0});
  test::write_bag(folder / "a.bag", events);
  const std::map<std::string, const RosType*> types = {
      {"/imu", &kImuType}, {"/points", &kPointCloud2Type}, {"/thermal/image", &kImageType}};
  rosbag::Bag bag((folder / "a.bag").string());
  std::size_t place = 0;
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    ASSERT_LT(place, events.size());
    EXPECT_EQ(static_cast<std::int64_t>(message.getTime().toNSec()), nanoseconds_of(events[place++].received));
    ASSERT_TRUE(types.contains(message.getTopic()));
    const RosType& type = *types.at(message.getTopic());
    EXPECT_EQ(message.getDataType(), type.name);
    EXPECT_EQ(message.getMD5Sum(), type.md5);
    EXPECT_EQ(message.getMessageDefinition(), type.definition);
  }
  EXPECT_EQ(place, events.size());
}

TEST(BagTwin, BothReadTheSameFromOurBags) {
  const TemporaryFolder folder;
  test::write_bag(folder / "a.bag", test::sample_events({.duration_s = 10.0}));
  expect_same_rows(rows_of_ours(folder / "a.bag"), rows_of_rosbag(folder / "a.bag"));
}

TEST(BagTwin, BothReadTheSameFromBagsOfAnyCompressionAndOrder) {
  const TemporaryFolder folder;
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    const auto path = folder / "a.bag";
    {
      rosbag::Bag bag(path.string(), rosbag::bagmode::Write);
      bag.setCompression(compression);
      bag.setChunkThreshold(2000);  // many chunks, which overlap in time because the messages are not in order
      std::mt19937 random(1);
      for (std::uint32_t i = 0; i < 400; ++i) {
        test::RawMessage message;
        message.type = "std_msgs/UInt8MultiArray";
        message.bytes.assign(random() % 300, static_cast<std::uint8_t>(i));
        bag.write(i % 3 == 0 ? "/a" : "/b", ros::Time(1000 + static_cast<std::uint32_t>(random() % 50), i), message);
      }
    }
    expect_same_rows(rows_of_ours(path), rows_of_rosbag(path));
  }
}

TEST(BagTwin, BothReadTheSameFromARealRecording) {
  PLLIT_RECORDING(path, "hilti_scan/hilti_scan.bag");
  expect_same_rows(rows_of_ours(path), rows_of_rosbag(path));
}

/// The definition without comments, blank lines and spaces.
std::string essence(const std::string& definition) {
  std::istringstream lines(definition);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string text;
    for (std::string word; words >> word;) text += word;
    if (!text.empty()) result += text + "\n";
  }
  return result;
}

TEST(BagTwin, OurDefinitionsAreThoseOfRealRecordings) {
  PLLIT_RECORDING(path, "hilti_scan/hilti_scan.bag");
  rosbag::Bag bag(path.string());
  std::size_t compared = 0;
  for (const rosbag::ConnectionInfo* connection : rosbag::View(bag).getConnections()) {
    for (const RosType& type : {kImuType, kPointCloud2Type, kImageType}) {
      if (connection->datatype != type.name) continue;
      EXPECT_EQ(connection->md5sum, type.md5);
      EXPECT_EQ(essence(connection->msg_def), essence(std::string(type.definition)));
      ++compared;
    }
  }
  EXPECT_GT(compared, 0u);
}

}  // namespace
}  // namespace pllit
