#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/write_support.hpp"
#include "pllit/io/tum.hpp"

namespace pllit {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kPose = " 1 2 3 0 0 0 1\n";

class TumFile : public ::testing::Test {
 protected:
  Expected<Trajectory> read(const std::string& text) const {
    write_file(path_, text).value();
    return read_tum(path_);
  }
  std::int64_t nanoseconds(const std::string& time) const {
    return nanoseconds_of(read(time + kPose).value().front().time);
  }
  std::string message(const std::string& text) const {
    const auto trajectory = read(text);
    return trajectory ? "was read" : trajectory.error().message;
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "path.tum";
};

StampedPose pose_of(std::int64_t nanoseconds, const Vector3d& phi, const Vector3d& position) {
  return {Time(Duration(nanoseconds)), pose_from(exp_so3(phi), position)};
}

TEST_F(TumFile, GivesBackWhatWasWritten) {
  Trajectory trajectory;
  for (int i = 0; i < 100; ++i)
    trajectory.push_back(pose_of(1403636579763555527 + 99999999LL * i, Vector3d(0.3, -0.02 * i, 0.1 * i),
                                 Vector3d(-1234.567890123 + i, 0.1 * i, 1e-6 * i)));
  ASSERT_TRUE(write_tum(path_, trajectory));
  const auto read = read_tum(path_);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), trajectory.size());
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    EXPECT_EQ(read->at(i).time, trajectory[i].time);
    EXPECT_TRUE(read->at(i).T_W_I.isApprox(trajectory[i].T_W_I, 2e-9)) << i;
  }
}

TEST_F(TumFile, HoldsSecondsWithNineDecimalsAndEightColumns) {
  const Vector3d zero = Vector3d::Zero();
  ASSERT_TRUE(write_tum(path_, {pose_of(-1, zero, zero), pose_of(1'000'000'002, zero, Vector3d(1, -2, 3))}));
  EXPECT_THAT(read_file(path_).value(),
              AllOf(HasSubstr("\n-0.000000001 0.000000000 "),
                    HasSubstr("\n1.000000002 1.000000000 -2.000000000 3.000000000 0.000000000 0.000000000 0.000000000 "
                              "1.000000000\n")));
}

TEST_F(TumFile, KeepsTimesToTheNanosecond) {
  EXPECT_EQ(nanoseconds("1403636579.763555527"), 1403636579763555527);
  EXPECT_EQ(nanoseconds("1.403636579763555527e+09"), 1403636579763555527);  // numpy.savetxt, evo
  EXPECT_EQ(nanoseconds("1317000000.051805"), 1317000000051805000);
  EXPECT_EQ(nanoseconds("12"), 12'000'000'000);
  EXPECT_EQ(nanoseconds("+.5"), 500'000'000);
  EXPECT_EQ(nanoseconds("-0.25"), -250'000'000);
  EXPECT_EQ(nanoseconds("25e-9"), 25);
  EXPECT_EQ(nanoseconds("1E-20"), 0);
  EXPECT_EQ(nanoseconds("0.00000000049"), 0);
  EXPECT_EQ(nanoseconds("0.9999999995"), 1'000'000'000);
}

TEST_F(TumFile, MayHoldCommentsBlankLinesTabsAndWindowsLineEnds) {
  const auto trajectory = read("# time x y z\r\n\r\n  \n1 1 2 3 0 0 0 1\r\n  # more\n2\t4 5  6 0 0 0 1");
  ASSERT_TRUE(trajectory) << trajectory.error().message;
  ASSERT_EQ(trajectory->size(), 2u);
  EXPECT_TRUE(trajectory->at(1).T_W_I.translation().isApprox(Vector3d(4, 5, 6)));
}

TEST_F(TumFile, NormalisesRoundedQuaternions) {
  const auto trajectory = read("1 0 0 0 0 0 0.707 0.707\n");
  ASSERT_TRUE(trajectory) << trajectory.error().message;
  EXPECT_NEAR(trajectory->front().T_W_I.quat().norm(), 1.0, 1e-15);
  EXPECT_TRUE((trajectory->front().T_W_I.rotation() * Vector3d::UnitX()).isApprox(Vector3d::UnitY(), 1e-12));
}

TEST_F(TumFile, IsRefusedWithFileAndLine) {
  const std::string first = "# header\n1 1 2 3 0 0 0 1\n";
  EXPECT_THAT(message(first + "2 1 2 3 0 0 1\n"), AllOf(HasSubstr("path.tum line 3: 7 columns, expected 8")));
  EXPECT_THAT(message(first + "2,1,2,3,0,0,0,1\n"), HasSubstr("line 3: 1 columns, expected 8 separated by spaces"));
  EXPECT_THAT(message(first + "2 1 nan 3 0 0 0 1\n"), HasSubstr("line 3: column 3: 'nan' is not a finite number"));
  EXPECT_THAT(message(first + "2 1 2 3 0 0 0 inf\n"), HasSubstr("line 3: column 8: 'inf' is not a finite number"));
  EXPECT_THAT(message(first + "2 1 2 3m 0 0 0 1\n"), HasSubstr("column 4: '3m'"));
  EXPECT_THAT(message(first + "nan 1 2 3 0 0 0 1\n"), HasSubstr("line 3: 'nan' is not a time"));
  EXPECT_THAT(message(first + "2 1 2 3 0 0 0 0\n"), HasSubstr("line 3: quaternion of length 0"));
  EXPECT_THAT(message(first + "2 1 2 3 0.5 0 0 1\n"), HasSubstr("line 3: quaternion of length 1.118"));
  EXPECT_THAT(message(first + "1 1 2 3 0 0 0 1\n"), HasSubstr("line 3: time 1.000000000 does not come after"));
  EXPECT_THAT(message(first + "0.5 1 2 3 0 0 0 1\n"), HasSubstr("line 3: time 0.500000000 does not come after"));
  EXPECT_THAT(message(std::string("1403636579763555527") + kPose), HasSubstr("nanosecond stamps: divide by 1e9"));
  EXPECT_THAT(message("1e400" + std::string(kPose)), HasSubstr("is not a time"));
  EXPECT_THAT(message("# nothing\n"), HasSubstr("path.tum: holds no pose"));
}

TEST_F(TumFile, IsRefusedWhereItIsAbsentOrAFolder) {
  const auto absent = read_tum(folder_ / "absent.tum");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().kind, Error::Kind::input);
  EXPECT_THAT(absent.error().message, HasSubstr("absent.tum: no such file"));
  EXPECT_THAT(read_tum(folder_ / "").error().message, HasSubstr("is a folder"));
}

TEST_F(TumFile, LosesOnlyItsUnfinishedLastLineWhereTheWriterWasKilled) {
  // Cut anywhere in the second line: even where the rest could pass for a pose, only the first one counts.
  const std::string first = "1 1 2 3 0 0 0 1\n", second = "2 1 2 3 0 0 0 1.000\n";
  for (std::size_t kept = 0; kept < second.size(); ++kept) {
    write_file(path_, first + second.substr(0, kept)).value();
    const auto trajectory = read_interrupted_tum(path_);
    ASSERT_TRUE(trajectory) << trajectory.error().message;
    EXPECT_EQ(trajectory->size(), 1u) << kept;
  }
  write_file(path_, first + second).value();
  EXPECT_EQ(read_interrupted_tum(path_)->size(), 2u);
  write_file(path_, "1 1 2").value();
  EXPECT_EQ(read_interrupted_tum(path_)->size(), 0u);
}

TEST_F(TumFile, HoldsEveryRowAsSoonAsItIsAppended) {
  auto writer = TumWriter::create(path_);
  ASSERT_TRUE(writer);
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(writer->append(pose_of(i, Vector3d::Zero(), Vector3d::Zero())));
    EXPECT_EQ(read_tum(path_)->size(), static_cast<std::size_t>(i));
  }
}

TEST_F(TumFile, TakesNoPoseThatItsReaderWouldRefuse) {
  auto writer = TumWriter::create(path_);
  ASSERT_TRUE(writer);
  const double nan = std::nan("");
  ASSERT_TRUE(writer->append(pose_of(5, Vector3d::Zero(), Vector3d::Zero())));
  EXPECT_THAT(writer->append(pose_of(6, Vector3d::Zero(), Vector3d(nan, 0, 0))).error().message,
              HasSubstr("is not finite"));
  EXPECT_THAT(writer->append(pose_of(5, Vector3d::Zero(), Vector3d::Zero())).error().message,
              HasSubstr("does not come after"));
  EXPECT_EQ(read_tum(path_)->size(), 1u);
}

TEST_F(TumFile, NamesItselfWhereTheDiskIsFull) {
  const auto full = write_tum("/dev/full", {pose_of(1, Vector3d::Zero(), Vector3d::Zero())});
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().kind, Error::Kind::failure);
  EXPECT_THAT(full.error().message, AllOf(HasSubstr("/dev/full"), HasSubstr("No space left")));
}

TEST_F(TumFile, StaysReadableWhereTheDiskFillsUp) {
  auto writer = TumWriter::create(path_);
  ASSERT_TRUE(writer);
  int written = 0;
  {
    const FullDisk disk(1000);
    while (const auto row = writer->append(pose_of(written + 1, Vector3d::Zero(), Vector3d::Zero()))) ++written;
  }
  EXPECT_GT(written, 5);
  const auto trajectory = read_tum(path_);
  ASSERT_TRUE(trajectory) << trajectory.error().message;
  EXPECT_EQ(trajectory->size(), static_cast<std::size_t>(written));
  EXPECT_TRUE(writer->append(pose_of(1000, Vector3d::Zero(), Vector3d::Zero()))) << "there is room again";
  EXPECT_EQ(read_tum(path_)->size(), static_cast<std::size_t>(written) + 1);
}

TEST_F(TumFile, IsRefusedWhereItsFolderIsMissing) {
  EXPECT_THAT(write_tum(folder_ / "no/path.tum", {}).error().message, StartsWith("cannot create "));
}

}  // namespace
}  // namespace pllit
