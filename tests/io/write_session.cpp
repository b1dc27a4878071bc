#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "io/write_support.hpp"
#include "pllit/io/session.hpp"

namespace pllit {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

const SessionLayout kLayout{{"time_s", "state"}, {"temperature_c", "n_obs"}};

StampedPose pose_number(int i) {
  return {Time(Duration(1'000'000'000LL * (i + 1))), pose_from(SO3::Identity(), Vector3d(i, 0, 0))};
}

class SessionFolder : public ::testing::Test {
 protected:
  /// A session with `frames` frames of ten points each, written by this process.
  SessionWriter written(int frames) const {
    auto session = SessionWriter::create(path_, kLayout).value();
    for (int i = 0; i < frames; ++i) append_frame(session, i);
    return session;
  }
  static void append_frame(SessionWriter& session, int i) {
    session.append_pose(pose_number(i)).value();
    session.append_health(std::vector<CsvCell>{i + 1.0, "good"}).value();
    session.append_map(some_points(10, static_cast<unsigned>(i))).value();
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_ / "results/hall";
};

TEST_F(SessionFolder, GivesBackWhatARunWrote) {
  auto writer = written(5);
  ASSERT_TRUE(writer.replace_trajectory({pose_number(3), pose_number(4)}));
  ASSERT_TRUE(writer.write_run(nlohmann::json{{"schema_version", 1}, {"frames", 5}}));
  const auto session = open_session(path_);
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->odometry.size(), 5u);
  ASSERT_EQ(session->trajectory.size(), 2u);
  EXPECT_EQ(session->trajectory[0].time, pose_number(3).time);
  EXPECT_EQ(session->health.columns, kLayout.health_columns);
  EXPECT_THAT(session->health.rows.at(4), ElementsAre("5", "good"));
  EXPECT_EQ(session->map.points.size(), 50u);
  ASSERT_TRUE(session->run);
  EXPECT_EQ(session->run->at("frames"), 5);
}

TEST_F(SessionFolder, HoldsEverythingUpToTheMomentOfAKill) {
  const pid_t child = fork();
  if (child == 0) {
    SessionWriter writer = written(7);
    std::raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  const auto session = open_session(path_);
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->trajectory.size(), 7u);
  EXPECT_EQ(session->odometry.size(), 7u);
  EXPECT_EQ(session->health.rows.size(), 7u);
  EXPECT_EQ(session->map.points.size(), 70u);
  EXPECT_FALSE(session->run);
}

TEST_F(SessionFolder, OpensWhereTheKillCutEveryFileShort) {
  written(3);
  const auto cut = [&](const char* name, std::uintmax_t bytes) {
    fs::resize_file(path_ / name, fs::file_size(path_ / name) - bytes);
  };
  cut("trajectory.tum", 5);
  cut("health.csv", 3);
  std::string map = read_file(path_ / "map.ply").value();
  write_file(path_ / "map.ply", map + "points whose count was not yet raised").value();
  write_file(path_ / "run.json.part", "{\"frames\":").value();
  const auto session = open_session(path_);
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->trajectory.size(), 2u);
  EXPECT_EQ(session->odometry.size(), 3u);
  EXPECT_EQ(session->health.rows.size(), 2u);
  EXPECT_EQ(session->map.points.size(), 30u);
  EXPECT_FALSE(session->run);
}

TEST_F(SessionFolder, IsNeverOverwritten) {
  written(2);
  fs::create_directory(path_.string() + "-2");
  const auto again = SessionWriter::create(path_, kLayout);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, Error::Kind::input);
  EXPECT_THAT(again.error().message,
              AllOf(HasSubstr("never overwritten"), HasSubstr("--out " + path_.string() + "-3")));
  EXPECT_EQ(open_session(path_)->trajectory.size(), 2u);
}

TEST_F(SessionFolder, MayExistIfItIsEmpty) {
  fs::create_directories(path_);
  EXPECT_TRUE(SessionWriter::create(path_ / "", kLayout));
}

TEST_F(SessionFolder, IsRefusedWhereAFileHasItsName) {
  write_file(folder_ / "file", "").value();
  EXPECT_THAT(SessionWriter::create(folder_ / "file", kLayout).error().message, HasSubstr("is a file"));
  EXPECT_THAT(SessionWriter::create(folder_ / "file/below", kLayout).error().message, HasSubstr("cannot create"));
}

TEST_F(SessionFolder, LinksToTheLatestRun) {
  for (const char* name : {"first", "second"}) {
    const fs::path session = folder_ / "results" / name;
    ASSERT_TRUE(SessionWriter::create(session, kLayout));
    ASSERT_TRUE(link_latest(session / ""));
    EXPECT_EQ(fs::canonical(folder_ / "results/latest"), fs::canonical(session));
  }
  EXPECT_TRUE(fs::read_symlink(folder_ / "results/latest").is_relative()) << "the results may be moved";
  EXPECT_TRUE(open_session(folder_ / "results/latest"));
}

TEST_F(SessionFolder, LeavesAFileCalledLatestAlone) {
  written(1);
  write_file(folder_ / "results/latest", "mine").value();
  EXPECT_THAT(link_latest(path_).error().message, HasSubstr("is not a link and stays as it is"));
  EXPECT_EQ(read_file(folder_ / "results/latest").value(), "mine");
}

TEST_F(SessionFolder, IsNamedAfterTheRecordingAndTheTimeInUtc) {
  const std::chrono::system_clock::time_point now = std::chrono::sys_days{std::chrono::year{2026} / 11 / 22} +
                                                    std::chrono::hours{3} + std::chrono::milliseconds{42'250};
  EXPECT_EQ(default_session_folder("results", "/data/exp 14.bag", now), "results/exp_14-20261122T030042Z");
  EXPECT_EQ(default_session_folder("out", "sim:hall?seed=3&motion=a/b.tum", now), "out/sim_hall-20261122T030042Z");
}

TEST_F(SessionFolder, KeepsItsOldRunRecordWhereTheDiskIsFull) {
  auto writer = written(1);
  ASSERT_TRUE(writer.write_run(nlohmann::json{{"frames", 1}}));
  {
    const FullDisk disk(10);
    const auto full = writer.write_run(nlohmann::json{{"frames", 2}});
    ASSERT_FALSE(full);
    EXPECT_THAT(full.error().message, HasSubstr("run.json"));
  }
  EXPECT_EQ(open_session(path_)->run->at("frames"), 1);
  EXPECT_FALSE(fs::exists(path_ / "run.json.part"));
}

TEST_F(SessionFolder, StaysReadableWhereTheDiskFillsUpWhileRunning) {
  auto writer = written(3);
  {
    const FullDisk disk(fs::file_size(path_ / "health.csv"));
    const auto pose = writer.append_pose(pose_number(3)), map = writer.append_map(some_points(10, 9));
    const auto health = writer.append_health(std::vector<CsvCell>{4.0, "good"});
    ASSERT_FALSE(pose || map || health);
    EXPECT_THAT(pose.error().message, HasSubstr("odometry.tum"));
    EXPECT_THAT(map.error().message, HasSubstr("map.ply"));
    EXPECT_THAT(health.error().message, HasSubstr("health.csv"));
  }
  const auto session = open_session(path_);
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->trajectory.size(), 3u);
  EXPECT_EQ(session->health.rows.size(), 3u);
  EXPECT_EQ(session->map.points.size(), 30u);
}

TEST_F(SessionFolder, TakesAChangeOfItsMapOnceAndOtherCloudsBesideIt) {
  auto writer = written(2);
  ASSERT_TRUE(writer.append_map(some_points(300000, 1)));  // several parts
  const PointTable before = open_session(path_)->map;
  ASSERT_TRUE(writer.change_map([](PointTable& part) {
    for (Eigen::Vector3f& p : part.points) p.x() += 1.0F;
  }));
  const PointTable after = open_session(path_)->map;
  ASSERT_EQ(after.points.size(), before.points.size());
  for (std::size_t i = 0; i < before.points.size(); ++i)
    ASSERT_EQ(after.points[i], before.points[i] + Eigen::Vector3f::UnitX()) << i;
  EXPECT_EQ(after.fields[1].values, before.fields[1].values);
  EXPECT_THAT(writer.append_map(some_points(1, 2)).error().message, HasSubstr("takes no more points"));
  ASSERT_TRUE(writer.write_cloud("thermal_map.ply", some_points(4, 3)));
  EXPECT_EQ(read_ply(path_ / "thermal_map.ply")->points.size(), 4u);
  ASSERT_TRUE(writer.write_text("report.html", "<html>"));
  EXPECT_EQ(read_file(path_ / "report.html").value(), "<html>");
}

TEST_F(SessionFolder, ChangesAMapWithoutPointsToOneWithout) {
  auto writer = written(0);
  ASSERT_TRUE(writer.change_map([](PointTable& part) { ASSERT_TRUE(part.points.empty()); }));
  EXPECT_TRUE(open_session(path_)->map.points.empty());
}

TEST_F(SessionFolder, GivesAsManyPointsOfItsMapAsOneAsksFor) {
  auto writer = written(2);
  ASSERT_TRUE(writer.append_map(some_points(5000, 1)));
  EXPECT_LE(open_session(path_, 1000)->map.points.size(), 1000u);
  EXPECT_GE(open_session(path_, 1000)->map.points.size(), 500u);
}

TEST_F(SessionFolder, IsRefusedWhereItIsNone) {
  EXPECT_THAT(open_session(folder_ / "absent").error().message, HasSubstr("absent: no such folder"));
  fs::create_directory(folder_ / "photos");
  EXPECT_THAT(open_session(folder_ / "photos").error().message, HasSubstr("photos: not a session"));
  written(1);
  write_file(path_ / "run.json", "{").value();
  EXPECT_THAT(open_session(path_).error().message, HasSubstr("run.json: is not JSON"));
}

}  // namespace
}  // namespace pllit
