#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/write_support.hpp"
#include "pllit/io/file.hpp"
#include "pllit/io/las.hpp"

namespace pllit {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A LAS file read by the byte offsets of the LAS 1.4 specification (R15): public header block in section 2.4, variable
/// length records in 2.5, point format 0 in 2.6, extra bytes in table 24.
struct RawLas {
  std::string bytes;
  std::uint32_t data_begin, points;
  std::uint16_t row_bytes;
  std::vector<std::string> extra_names;

  explicit RawLas(const std::filesystem::path& path)
      : bytes(read_file(path).value()),
        data_begin(number_at<std::uint32_t>(bytes, 96)),
        points(number_at<std::uint32_t>(bytes, 107)),
        row_bytes(number_at<std::uint16_t>(bytes, 105)) {
    const auto records = number_at<std::uint32_t>(bytes, 100);
    std::size_t begin = number_at<std::uint16_t>(bytes, 94);
    for (std::uint32_t record = 0; record < records; ++record) {
      const auto length = number_at<std::uint16_t>(bytes, begin + 20);
      if (text(begin + 2) == "LASF_Spec" && number_at<std::uint16_t>(bytes, begin + 18) == 4)
        for (std::size_t entry = begin + 54; entry < begin + 54 + length; entry += 192) {
          EXPECT_EQ(number_at<std::uint8_t>(bytes, entry + 2), 9) << "data type float";
          EXPECT_EQ(number_at<std::uint8_t>(bytes, entry + 3), 0) << "no options";
          extra_names.push_back(text(entry + 4));
        }
      begin += 54 + length;
    }
    EXPECT_EQ(begin, data_begin) << "the records end where the points begin";
  }

  std::string text(std::size_t offset) const { return bytes.c_str() + offset; }
  double real(std::size_t offset) const { return number_at<double>(bytes, offset); }
  Eigen::Vector3d reals(std::size_t offset, std::size_t step) const {
    return {real(offset), real(offset + step), real(offset + 2 * step)};
  }
  Eigen::Vector3d point(std::size_t i) const {
    const std::size_t row = data_begin + i * row_bytes;
    const Eigen::Vector3d integers(number_at<std::int32_t>(bytes, row), number_at<std::int32_t>(bytes, row + 4),
                                   number_at<std::int32_t>(bytes, row + 8));
    return integers.cwiseProduct(reals(131, 8)) + reals(155, 8);
  }
  float extra(std::size_t i, std::size_t field) const {
    return number_at<float>(bytes, data_begin + i * row_bytes + 20 + 4 * field);
  }
};

class LasFile : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "map.las";
};

TEST_F(LasFile, HasTheHeaderThatVersion14AsksFor) {
  ASSERT_TRUE(write_las(path_, some_points(70'000, 1)));
  const RawLas las(path_);
  EXPECT_EQ(las.bytes.substr(0, 4), "LASF");
  EXPECT_EQ(number_at<std::uint16_t>(las.bytes, 6), 0) << "global encoding";
  EXPECT_EQ(las.bytes[24], 1);
  EXPECT_EQ(las.bytes[25], 4);
  EXPECT_EQ(las.text(58), "PL-LIT");
  EXPECT_EQ(number_at<std::uint16_t>(las.bytes, 94), 375);
  EXPECT_EQ(las.data_begin, 375u + 54 + 2 * 192);
  EXPECT_EQ(las.bytes[104], 0) << "point format";
  EXPECT_EQ(las.row_bytes, 20 + 2 * 4);
  EXPECT_EQ(las.points, 70'000u);
  EXPECT_EQ(number_at<std::uint32_t>(las.bytes, 111), 70'000u) << "first returns, legacy";
  EXPECT_EQ(number_at<std::uint64_t>(las.bytes, 235), 0u) << "no extended records";
  EXPECT_EQ(number_at<std::uint64_t>(las.bytes, 247), 70'000u);
  EXPECT_EQ(number_at<std::uint64_t>(las.bytes, 255), 70'000u) << "first returns";
  EXPECT_EQ(number_at<std::uint64_t>(las.bytes, 263), 0u) << "second returns";
  EXPECT_EQ(las.bytes.size(), las.data_begin + 70'000u * las.row_bytes);
}

TEST_F(LasFile, KeepsPointsToATenthOfAMillimetreAndFieldsExactly) {
  const PointTable table = some_points(70'000, 2);
  ASSERT_TRUE(write_las(path_, table));
  const RawLas las(path_);
  EXPECT_THAT(las.extra_names, ElementsAre("temperature_c", "n_obs"));
  Eigen::Vector3d low = las.point(0), high = low;
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    ASSERT_LT((las.point(i) - table.points[i].cast<double>()).cwiseAbs().maxCoeff(), 0.51e-4);
    ASSERT_EQ(las.extra(i, 0), table.fields[0].values[i]);
    ASSERT_EQ(las.extra(i, 1), table.fields[1].values[i]);
    ASSERT_EQ(las.bytes[las.data_begin + i * las.row_bytes + 14], 0b00001001) << "return 1 of 1";
    low = low.cwiseMin(las.point(i));
    high = high.cwiseMax(las.point(i));
  }
  EXPECT_TRUE(las.reals(179, 16).isApprox(high, 1e-15)) << "maximum in the header";
  EXPECT_TRUE(las.reals(187, 16).isApprox(low, 1e-15)) << "minimum in the header";
}

TEST_F(LasFile, CoarsensItsScaleWhereTheCloudIsTooWide) {
  const PointTable table{{{-3e6F, 0, 0}, {3e6F, 1, 2}}, {}};
  ASSERT_TRUE(write_las(path_, table));
  const RawLas las(path_);
  EXPECT_DOUBLE_EQ(las.real(131), 1e-2);
  EXPECT_LT((las.point(1) - Eigen::Vector3d(3e6, 1, 2)).norm(), 1e-2);
  EXPECT_LT((las.point(0) - Eigen::Vector3d(-3e6, 0, 0)).norm(), 1e-2);
}

TEST_F(LasFile, NeedsNoRecordsWithoutFieldsAndMayBeEmpty) {
  ASSERT_TRUE(write_las(path_, {}));
  const RawLas las(path_);
  EXPECT_EQ(las.points, 0u);
  EXPECT_EQ(las.data_begin, 375u);
  EXPECT_EQ(las.row_bytes, 20);
  EXPECT_EQ(las.bytes.size(), 375u);
}

TEST_F(LasFile, IsTheSameForTheSameCloud) {
  ASSERT_TRUE(write_las(path_, some_points(100, 3)));
  ASSERT_TRUE(write_las(folder_ / "again.las", some_points(100, 3)));
  EXPECT_EQ(read_file(path_).value(), read_file(folder_ / "again.las").value());
}

TEST_F(LasFile, NamesItselfWhereTheDiskIsFull) {
  EXPECT_THAT(write_las("/dev/full", some_points(10, 4)).error().message,
              AllOf(HasSubstr("/dev/full"), HasSubstr("No space left")));
  const FullDisk disk(100'000);
  EXPECT_THAT(write_las(path_, some_points(70'000, 5)).error().message, HasSubstr("map.las"));
}

TEST_F(LasFile, TakesNoMoreFieldsThanItsRecordHolds) {
  PointTable table{{{1, 2, 3}}, {}};
  for (int i = 0; i < 342; ++i) table.fields.push_back({std::format("field_{}", i), {0.0F}});
  EXPECT_THAT(write_las(path_, table).error().message, HasSubstr("more than LAS holds"));
  table.fields.pop_back();
  ASSERT_TRUE(write_las(path_, table));
  EXPECT_EQ(RawLas(path_).extra_names.size(), 341u);
}

}  // namespace
}  // namespace pllit
