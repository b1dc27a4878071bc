#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "pllit/io/session.hpp"
#include "run_program.hpp"
#include "support/full_disk.hpp"

namespace pllit {
namespace {

using testing::HasSubstr;

class RunVerb : public test::ProgramTest {};

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
