#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "io/write_support.hpp"
#include "pllit/io/file.hpp"
#include "pllit/io/pcd.hpp"

namespace pllit {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A PCD file as its specification says: lines of KEY VALUES up to DATA, then the points.
struct RawPcd {
  std::map<std::string, std::string> header;
  std::string body;

  explicit RawPcd(const std::filesystem::path& path) {
    std::istringstream bytes(read_file(path).value());
    for (std::string line; !header.contains("DATA") && std::getline(bytes, line);)
      if (!line.starts_with('#')) header[line.substr(0, line.find(' '))] = line.substr(line.find(' ') + 1);
    std::ostringstream rest;
    rest << bytes.rdbuf();
    body = rest.str();
  }
};

TEST(PcdFile, HasTheBytesThatVersion07AsksFor) {
  const TemporaryFolder folder;
  const PointTable table = some_points(70'000, 1);
  ASSERT_TRUE(write_pcd(folder / "map.pcd", table));
  const RawPcd raw(folder / "map.pcd");
  const std::map<std::string, std::string> expected{{"VERSION", "0.7"},     {"FIELDS", "x y z temperature_c n_obs"},
                                                    {"SIZE", "4 4 4 4 4"},  {"TYPE", "F F F F F"},
                                                    {"COUNT", "1 1 1 1 1"}, {"WIDTH", "70000"},
                                                    {"HEIGHT", "1"},        {"VIEWPOINT", "0 0 0 1 0 0 0"},
                                                    {"POINTS", "70000"},    {"DATA", "binary"}};
  EXPECT_EQ(raw.header, expected);
  ASSERT_EQ(raw.body.size(), 70'000u * 20);
  for (const std::size_t i : {0u, 1u, 69'999u}) {
    EXPECT_EQ(number_at<float>(raw.body, 20 * i + 4), table.points[i].y());
    EXPECT_EQ(number_at<float>(raw.body, 20 * i + 12), table.fields[0].values[i]);
    EXPECT_EQ(number_at<float>(raw.body, 20 * i + 16), static_cast<float>(i));
  }
}

TEST(PcdFile, MayBeEmpty) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_pcd(folder / "map.pcd", {}));
  EXPECT_EQ(RawPcd(folder / "map.pcd").header.at("POINTS"), "0");
}

TEST(PcdFile, NamesItselfWhereTheDiskIsFull) {
  EXPECT_THAT(write_pcd("/dev/full", some_points(10, 2)).error().message,
              AllOf(HasSubstr("/dev/full"), HasSubstr("No space left")));
  const TemporaryFolder folder;
  const FullDisk disk(100'000);
  EXPECT_THAT(write_pcd(folder / "map.pcd", some_points(70'000, 3)).error().message, HasSubstr("map.pcd"));
}

TEST(PcdFile, TakesNoNameWithASpace) {
  const TemporaryFolder folder;
  EXPECT_THAT(write_pcd(folder / "map.pcd", {{{1, 2, 3}}, {{"delta t", {1.0F}}}}).error().message,
              HasSubstr("scalar field 'delta t'"));
}

}  // namespace
}  // namespace pllit
