#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/write_support.hpp"
#include "pllit/io/csv.hpp"

namespace pllit {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::vector<std::string> kColumns{"time_s", "points", "state"};

class CsvFile : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "health.csv";
};

TEST_F(CsvFile, GivesBackNumbersAndTextWithEveryAwkwardCharacter) {
  auto writer = CsvWriter::create(path_, kColumns);
  ASSERT_TRUE(writer);
  const double third = 1.0 / 3.0;
  ASSERT_TRUE(writer->append(std::vector<CsvCell>{third, std::int64_t{-7}, "good"}));
  ASSERT_TRUE(writer->append(std::vector<CsvCell>{std::nan(""), std::int64_t{0}, "a, \"b\"\nc"}));
  ASSERT_TRUE(writer->append(std::vector<CsvCell>{1e-300, std::int64_t{0}, ""}));
  const auto table = read_csv(path_);
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(table->columns, kColumns);
  ASSERT_EQ(table->rows.size(), 3u);
  EXPECT_EQ(std::stod(table->rows[0][0]), third) << "no digit is lost";
  EXPECT_THAT(table->rows[0], ElementsAre(testing::_, "-7", "good"));
  EXPECT_THAT(table->rows[1], ElementsAre("", "0", "a, \"b\"\nc"));
  EXPECT_EQ(std::stod(table->rows[2][0]), 1e-300);
}

TEST_F(CsvFile, LosesOnlyItsUnfinishedLastRowWhereTheWriterWasKilled) {
  const std::string head = "a,b\n1,2\n", last = "3,\"x\ny\"\n";
  for (std::size_t kept = 0; kept < last.size(); ++kept) {
    write_file(path_, head + last.substr(0, kept)).value();
    const auto table = read_csv(path_);
    ASSERT_TRUE(table) << table.error().message;
    EXPECT_THAT(table->rows, ElementsAre(ElementsAre("1", "2"))) << kept;
  }
}

TEST_F(CsvFile, TakesOnlyRowsAsLongAsItsHeader) {
  auto writer = CsvWriter::create(path_, kColumns);
  ASSERT_TRUE(writer);
  EXPECT_THAT(writer->append(std::vector<CsvCell>{1.0}).error().message,
              HasSubstr("a row of 1 cells, the table has 3 columns"));
  EXPECT_THAT(read_csv(path_)->rows, IsEmpty());
}

TEST_F(CsvFile, IsRefusedWithTheRowThatDoesNotFit) {
  write_file(path_, "a,b\n1,2\n1,2,3\n").value();
  EXPECT_THAT(read_csv(path_).error().message, AllOf(HasSubstr("health.csv row 2"), HasSubstr("3 cells")));
  write_file(path_, "").value();
  EXPECT_THAT(read_csv(path_).error().message, HasSubstr("holds no header row"));
}

TEST_F(CsvFile, NamesItselfWhereTheDiskIsFull) {
  EXPECT_THAT(CsvWriter::create("/dev/full", kColumns).error().message, HasSubstr("/dev/full"));
}

}  // namespace
}  // namespace pllit
