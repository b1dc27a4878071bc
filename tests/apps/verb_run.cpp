#include <algorithm>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "pllit/io/session.hpp"
#include "run_program.hpp"
#include "support/full_disk.hpp"

namespace pllit {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class RunVerb : public test::ProgramTest {
 protected:
  bool some_poses_written(pid_t process) const { return waited_for(process, path("session/trajectory.tum"), 1000); }
  /// A short recording of a simple room.
  std::string bag() const {
    const auto made =
        run({"simulate", "box_room", "--duration", "6", "--set", "lidar=ring16", "--out", path("room.bag")});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return path("room.bag");
  }
  std::string session_path() const { return path("session"); }
};

/// Its tables agree with each other.
void expect_whole(const Session& session) {
  EXPECT_GT(session.trajectory.size(), 5u);
  EXPECT_EQ(session.odometry.size(), session.trajectory.size());
  EXPECT_EQ(session.health.rows.size(), session.trajectory.size());
  EXPECT_GT(session.map.points.size(), 0u);
}

TEST_F(RunVerb, LeavesAWholeSessionAfterCtrlC) {
  // The second scene's world has been built by many threads before the run begins: none of them may take the signal.
  for (const char* scene : {"sim:box_room?duration=3000&lidar=ring16", "sim:room?images=none"}) {
    for (const int signal : {SIGINT, SIGTERM}) {
      std::filesystem::remove_all(session_path());
      const pid_t process = start({"run", scene, "--out", session_path()});
      const bool running = some_poses_written(process);
      kill(process, signal);
      const auto [exit_code, out, err] = finished(process);
      ASSERT_TRUE(running) << err;
      EXPECT_EQ(exit_code, 1) << err;
      EXPECT_THAT(out, HasSubstr("session     " + session_path()));
      EXPECT_THAT(err, HasSubstr("interrupted; what was done is in " + session_path()));
      const auto session = open_session(session_path());
      ASSERT_TRUE(session) << session.error().message;
      expect_whole(*session);
      ASSERT_TRUE(session->run);
      EXPECT_EQ(session->run->at("status"), "interrupted");
      EXPECT_EQ(session->run->at("frames"), session->trajectory.size());
    }
  }
}

TEST_F(RunVerb, LosesNothingThatWasDoneWhereItIsKilled) {
  const pid_t process = start({"run", "sim:box_room?duration=3000&lidar=ring16", "--out", session_path()});
  const bool running = some_poses_written(process);
  kill(process, SIGKILL);
  EXPECT_EQ(finished(process).exit_code, -1);
  ASSERT_TRUE(running);
  const auto session = open_session(session_path());
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_GT(session->trajectory.size(), 5u);
  EXPECT_GE(session->trajectory.size(), session->health.rows.size());
  EXPECT_LE(session->trajectory.size(), session->health.rows.size() + 1);  // killed between the two
  EXPECT_GT(session->map.points.size(), 0u);
  ASSERT_TRUE(session->run);
  EXPECT_EQ(session->run->at("status"), "unfinished");
}

TEST_F(RunVerb, TakesWhatCanBeReadOfATruncatedBagAndSaysWhatIsMissing) {
  const std::string whole = bag();
  const std::string bytes = read(whole);
  const std::string cut = write("cut.bag", bytes.substr(0, bytes.size() * 2 / 3));
  const auto [exit_code, out, err] = run({"run", cut, "--out", session_path()});
  EXPECT_EQ(exit_code, 0) << err;
  EXPECT_THAT(out, HasSubstr("has no complete index"));
  const auto session = open_session(session_path());
  ASSERT_TRUE(session) << session.error().message;
  expect_whole(*session);
  EXPECT_LT(session->trajectory.size(), 50u);
}

TEST_F(RunVerb, SaysInWordsWhyARunThatEndsWellIsNotToBeTrusted) {
  const auto [exit_code, out, err] =
      run({"run", "sim:box_room?duration=12&lidar=ring16&lidar_gap=5:8", "--out", session_path()});
  EXPECT_EQ(exit_code, 3) << err;
  EXPECT_THAT(out, AllOf(HasSubstr("good at the end"), HasSubstr("more than a tenth (therefore exit code 3)")));
}

TEST_F(RunVerb, TellsOfHeatWhereTheCameraSeesHeatAndOfNoneWhereItSeesLight) {
  const auto told = [&](const std::string& rig) {
    std::filesystem::remove_all(session_path());
    const auto done = run({"run", "sim:room?image_rate=2&duration=3&rig=" + rig, "--events", "--out", session_path()});
    EXPECT_NE(done.exit_code, 2) << done.err;
    return done.err;
  };
  EXPECT_THAT(told("hilti2022"), HasSubstr("there will be no alarms"));
  EXPECT_FALSE(std::filesystem::exists(session_path() + "/thermal_map.ply"));
  EXPECT_FALSE(std::filesystem::exists(session_path() + "/anomalies.json"));
  EXPECT_THAT(told("inspection"), testing::Not(HasSubstr("no alarms")));
  EXPECT_TRUE(std::filesystem::exists(session_path() + "/thermal_map.ply"));
}

TEST_F(RunVerb, RefusesWrongInputWithExitCodeTwoAndLeavesNothingBehind) {
  const std::string empty = write("empty.bag", "");
  const std::string text = write("text.bag", "no recording");
  const std::string table = write("table.yaml", "scheme: mine\nclasses:\n  - {from_k: 1, name: a, action: b}\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{path("absent.bag")}, "absent.bag' does not exist"},
      {{empty}, "is empty"},
      {{text}, "not a ROS 1 bag"},
      {{"sim:box_rom"}, "did you mean box_room"},
      {{"sim:box_room?durration=5"}, "durration"},
      {{"sim:box_room", text}, "a simulation stands alone"},
      {{"sim:box_room", "--config", "kiti"}, "did you mean 'kitti'?"},
      {{"sim:box_room", "--set", "map.voxl_m=1"}, "did you mean 'map.voxel_m'?"},
      {{"sim:box_room", "--set", "map.voxel_m=-1"}, "out of range"},
      {{"sim:box_room", "--set", "advanced.report.severity=" + table}, "table.yaml:3: unknown key 'from_k'"},
      {{"sim:box_room", "--set", "advanced.report.severity=" + path("none.yaml")}, "none.yaml: no such file"},
      {{"sim:box_room", "--truth", path("absent.tum")}, "absent.tum"},
      {{"sim:box_room", "--truth", text}, "text.bag"}};
  for (const auto& [sources, message] : cases) {
    std::vector<std::string> arguments{"run", "--out", session_path()};
    arguments.insert(arguments.end(), sources.begin(), sources.end());
    const auto [exit_code, out, err] = run(arguments);
    EXPECT_EQ(exit_code, 2) << err;
    EXPECT_THAT(out, IsEmpty());
    EXPECT_THAT(err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(session_path())) << testing::PrintToString(sources);
  }
}

TEST_F(RunVerb, NeverWritesIntoASessionThatIsThere) {
  std::filesystem::create_directory(session_path());
  write("session/trajectory.tum", "precious");
  const auto [exit_code, out, err] = run({"run", "sim:box_room?duration=3", "--out", session_path()});
  EXPECT_EQ(exit_code, 2);
  EXPECT_THAT(err, HasSubstr(session_path()));
  EXPECT_EQ(read(path("session/trajectory.tum")), "precious");
}

TEST_F(RunVerb, LeavesAReadableSessionWhereTheDiskFillsUp) {
  const std::string folder = path("session");
  const auto [exit_code, out, err] = [&] {
    const test::FullDisk disk(400'000);
    return run({"run", "sim:box_room?duration=5&lidar=ring16", "--out", folder});
  }();
  EXPECT_EQ(exit_code, 1);
  EXPECT_THAT(err, HasSubstr("cannot write " + folder + "/map.ply: File too large"));
  const auto session = open_session(folder);
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_THAT(session->trajectory.size(), testing::AllOf(testing::Gt(0u), testing::Lt(50u)));
  EXPECT_EQ(session->health.rows.size(), session->trajectory.size());
  EXPECT_GT(session->map.points.size(), 0u);
  ASSERT_TRUE(session->run);
  EXPECT_EQ(session->run->at("status"), "failed");
  EXPECT_THAT(session->run->at("error").get<std::string>(), HasSubstr("map.ply"));
}

/// A walk of some 70 m about a room: it comes by the same places again and again.
TEST_F(RunVerb, ClosesLoopsAndLeavesTheOdometryAsItWas) {
  const std::string address = "sim:box_room?duration=60&speed=1.3&lidar=ring16";
  ASSERT_EQ(run({"run", address, "--out", path("closed")}).exit_code, 0);
  ASSERT_EQ(run({"run", address, "--out", path("open"), "--set", "loop.enabled=false"}).exit_code, 0);
  const auto closed = open_session(path("closed")), open = open_session(path("open"));
  ASSERT_TRUE(closed && open);
  const auto same = [](const Trajectory& a, const Trajectory& b) {
    return std::ranges::equal(a, b, [](const StampedPose& p, const StampedPose& q) {
      return p.time == q.time && p.T_W_I.coeffs() == q.T_W_I.coeffs();
    });
  };
  EXPECT_TRUE(same(closed->odometry, open->odometry));
  EXPECT_TRUE(same(open->trajectory, open->odometry));
  EXPECT_EQ(closed->trajectory.size(), closed->odometry.size());
  EXPECT_EQ(closed->map.points.size(), open->map.points.size());
  EXPECT_FALSE(std::filesystem::exists(path("open") + "/loops.csv"));
  const auto loops = read_csv(path("closed") + "/loops.csv");
  ASSERT_TRUE(loops) << loops.error().message;
  const int accepted = closed->run->at("loops").at("accepted"), rejected = closed->run->at("loops").at("rejected");
  EXPECT_GT(accepted, 0);
  EXPECT_FALSE(same(closed->trajectory, closed->odometry));
  EXPECT_EQ(static_cast<std::size_t>(accepted + rejected), loops->rows.size());
  EXPECT_LT(closed->run->at("ape").at("rmse").get<double>(), 0.05);
}

}  // namespace
}  // namespace pllit
