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

}  // namespace
}  // namespace pllit
