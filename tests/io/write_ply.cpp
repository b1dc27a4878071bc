#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "io/write_support.hpp"
#include "pllit/io/ply.hpp"
#include "pllit/io/point_records.hpp"

namespace pllit {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The lines of a PLY header and the bytes behind it, cut at `end_header` as the format defines.
struct RawPly {
  std::vector<std::string> header;
  std::string body;

  explicit RawPly(const std::filesystem::path& path) {
    const std::string bytes = read_file(path).value(), end = "end_header\n";
    const auto header_end = bytes.find(end) + end.size();
    std::istringstream lines(bytes.substr(0, header_end));
    for (std::string line; std::getline(lines, line);)
      if (!line.starts_with("comment")) header.push_back(line);
    body = bytes.substr(header_end);
  }
};

class PlyFile : public ::testing::Test {
 protected:
  std::string message(const std::string& bytes) const {
    write_file(path_, bytes).value();
    const auto table = read_ply(path_);
    return table ? "was read" : table.error().message;
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "map.ply";
};

TEST_F(PlyFile, HasTheBytesThatTheFormatAsksFor) {
  const PointTable table{{{1, 2, 3}, {4, 5, 6}}, {{"temperature_c", {20.5F, -3.0F}}}};
  ASSERT_TRUE(write_ply(path_, table));
  const RawPly raw(path_);
  EXPECT_THAT(raw.header,
              ElementsAre("ply", "format binary_little_endian 1.0", "element vertex 0000000002", "property float x",
                          "property float y", "property float z", "property float temperature_c", "end_header"));
  ASSERT_EQ(raw.body.size(), 2u * 4 * sizeof(float));
  EXPECT_EQ(number_at<float>(raw.body, 0), 1.0F);
  EXPECT_EQ(number_at<float>(raw.body, 12), 20.5F);
  EXPECT_EQ(number_at<float>(raw.body, 16), 4.0F);
  EXPECT_EQ(number_at<float>(raw.body, 28), -3.0F);
}

TEST_F(PlyFile, GivesBackWhatWasWritten) {
  for (const std::size_t count : {0u, 1u, 70'000u}) {  // 70 000: more than one chunk
    const PointTable table = some_points(count, 1);
    ASSERT_TRUE(write_ply(path_, table));
    const auto read = read_ply(path_);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_TRUE(same_points(*read, table)) << count;
  }
}

TEST_F(PlyFile, OfAStreamIsTheOneWrittenAtOnce) {
  const PointTable whole = some_points(1000, 2);
  auto stream = PlyStream::create(path_, field_names(whole));
  ASSERT_TRUE(stream);
  for (std::size_t begin = 0; begin < 1000; begin += 250) {
    PointTable part{{whole.points.begin() + begin, whole.points.begin() + begin + 250}, {}};
    for (const ScalarField& field : whole.fields)
      part.fields.push_back({field.name, {field.values.begin() + begin, field.values.begin() + begin + 250}});
    ASSERT_TRUE(stream->append(part));
    EXPECT_EQ(read_ply(path_)->points.size(), begin + 250) << "the file is whole after every append";
  }
  ASSERT_TRUE(stream->close());
  ASSERT_TRUE(write_ply(folder_ / "whole.ply", whole));
  EXPECT_EQ(read_file(path_).value(), read_file(folder_ / "whole.ply").value());
}

TEST_F(PlyFile, IsTheSamePartByPart) {
  const PointTable whole = some_points(1000, 2);
  ASSERT_TRUE(write_ply(path_, whole));
  auto reader = PlyReader::open(path_);
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->size(), 1000u);
  std::vector<Eigen::Vector3f> points;
  std::vector<float> values;
  for (const std::size_t size : {1u, 0u, 700u, 900u}) {
    const auto part = reader->next(size);
    ASSERT_TRUE(part) << part.error().message;
    points.insert(points.end(), part->points.begin(), part->points.end());
    values.insert(values.end(), part->fields[0].values.begin(), part->fields[0].values.end());
  }
  EXPECT_EQ(points, whole.points);
  EXPECT_EQ(values, whole.fields[0].values);
  EXPECT_TRUE(reader->next(10)->points.empty());
}

TEST_F(PlyFile, IsThinnedEvenlyWhereItHasMorePointsThanOneWants) {
  const PointTable whole = some_points(200000, 3);
  ASSERT_TRUE(write_ply(path_, whole));
  const auto thin = read_ply(path_, 30000);  // one in seven
  ASSERT_TRUE(thin);
  ASSERT_EQ(thin->points.size(), (200000u + 6u) / 7u);
  for (std::size_t i = 0; i < thin->points.size(); ++i) ASSERT_EQ(thin->points[i], whole.points[7 * i]) << i;
  EXPECT_EQ(thin->fields[1].values.back(), whole.fields[1].values[7 * (thin->points.size() - 1)]);
}

TEST_F(PlyFile, MayHoldOtherNumberTypesBesideFloat) {
  std::string bytes =
      "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 1\r\nproperty double x\r\nproperty float64 y\r\n"
      "property float z\r\nproperty uchar red\r\nproperty int16 level\r\nelement face 0\r\n"
      "property list uchar int vertex_indices\r\nend_header\r\n";
  append_bytes(bytes, 1.5);
  append_bytes(bytes, -2.5);
  append_bytes(bytes, 3.5F);
  append_bytes<std::uint8_t>(bytes, 200);
  append_bytes<std::int16_t>(bytes, -7);
  write_file(path_, bytes).value();
  const auto table = read_ply(path_);
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_TRUE(same_points(*table, {{{1.5F, -2.5F, 3.5F}}, {{"red", {200.0F}}, {"level", {-7.0F}}}}));
}

TEST_F(PlyFile, IsReadUpToItsPromisedPointsWhereMoreBytesFollow) {
  const PointTable table = some_points(10, 3);
  ASSERT_TRUE(write_ply(path_, table));
  write_file(path_, read_file(path_).value() + "half a po").value();
  EXPECT_TRUE(same_points(read_ply(path_).value(), table));
}

TEST_F(PlyFile, IsRefusedWithTheReason) {
  const std::string head = "ply\nformat binary_little_endian 1.0\n", xyz = "property float x\nproperty float y\n";
  EXPECT_THAT(message("LASF"), AllOf(HasSubstr("map.ply"), HasSubstr("is not a PLY file")));
  EXPECT_THAT(message("ply\nformat ascii 1.0\nend_header\n"), HasSubstr("format 'ascii'"));
  EXPECT_THAT(message(head + "element vertex 1\n"), HasSubstr("header does not end"));
  EXPECT_THAT(message(head + "element vertex 1\n" + xyz + "end_header\n"), HasSubstr("need one property z"));
  EXPECT_THAT(message(head + "element vertex many\nend_header\n"), HasSubstr("number of vertices"));
  EXPECT_THAT(message(head + "element vertex 1\nproperty list uchar int x\nend_header\n"),
              HasSubstr("is not a number"));
  EXPECT_THAT(message(head + "element face 1\nelement vertex 1\nend_header\n"),
              HasSubstr("vertices do not come first"));
  EXPECT_THAT(message(head + "element vertex 9999999999\n" + xyz + "property float z\nend_header\n0123456789ab"),
              HasSubstr("promises 9999999999 points and holds 1: the file was cut"));
}

TEST_F(PlyFile, TakesNoFieldsThatReadersWouldTripOver) {
  for (const std::string name : {"", "x", "two words", "n_obs", "a_name_that_is_longer_than_las_can_hold", "\n"}) {
    const PointTable table{{{1, 2, 3}}, {{"n_obs", {1.0F}}, {name, {1.0F}}}};
    EXPECT_THAT(write_ply(path_, table).error().message, HasSubstr("scalar field '" + name + "'"));
  }
  EXPECT_THAT(write_ply(path_, {{{1, 2, 3}}, {{"n_obs", {1.0F, 2.0F}}}}).error().message,
              HasSubstr("'n_obs' has 2 values for 1 points"));
}

TEST_F(PlyFile, TakesNoPointThatIsNotFiniteButAnUnknownValue) {
  const float nan = std::nanf("");
  EXPECT_THAT(write_ply(path_, {{{0, 0, 0}, {1, nan, 3}}, {}}).error().message, HasSubstr("point 1 is not finite"));
  ASSERT_TRUE(write_ply(path_, {{{0, 0, 0}}, {{"temperature_c", {nan}}}}));
  EXPECT_TRUE(std::isnan(read_ply(path_)->fields[0].values[0]));
}

TEST_F(PlyFile, RefusesPointsWithOtherFieldsThanTheStreams) {
  auto stream = PlyStream::create(path_, {"n_obs"});
  ASSERT_TRUE(stream);
  EXPECT_THAT(stream->append(some_points(1, 4)).error().message, HasSubstr("are not those of the file"));
}

TEST_F(PlyFile, NamesItselfWhereTheDiskIsFull) {
  const auto full = write_ply("/dev/full", some_points(10, 5));
  ASSERT_FALSE(full);
  EXPECT_THAT(full.error().message, AllOf(HasSubstr("/dev/full"), HasSubstr("No space left")));
}

TEST_F(PlyFile, KeepsTheAppendsBeforeTheOneThatFilledTheDisk) {
  const PointTable part = some_points(100, 6);  // 2000 bytes
  auto stream = PlyStream::create(path_, field_names(part));
  ASSERT_TRUE(stream);
  std::size_t written = 0;
  {
    const FullDisk disk(9000);
    while (stream->append(part)) ++written;
  }
  EXPECT_EQ(written, 4u);
  EXPECT_EQ(read_ply(path_)->points.size(), 400u);
  EXPECT_EQ(RawPly(path_).body.size(), 400u * 5 * sizeof(float)) << "half an append would shift the next one";
  ASSERT_TRUE(stream->append(part)) << "there is room again";
  EXPECT_EQ(read_ply(path_)->points.back(), part.points.back());
}

}  // namespace
}  // namespace pllit
