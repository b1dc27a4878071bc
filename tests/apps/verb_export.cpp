#include "pllit/io/ply.hpp"
#include "pllit/io/session.hpp"
#include "pllit/io/tum.hpp"
#include "run_program.hpp"

namespace pllit {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class ExportVerb : public test::ProgramTest {
 protected:
  /// A session of two poses and three points.
  std::string session() const {
    const std::string folder = path("session");
    auto writer = SessionWriter::create(folder, {.health_columns = {"time"}, .map_fields = {"intensity"}});
    EXPECT_TRUE(writer) << writer.error().message;
    for (const int second : {1, 2}) {
      const StampedPose pose{Time(std::chrono::seconds(second)), SE3(Vector3d(second, 0.0, 0.0), SO3::Identity())};
      EXPECT_TRUE(writer->append_pose(pose));
    }
    const PointTable table{{{1.0F, 0.0F, 0.0F}, {0.0F, 2.0F, 0.0F}, {0.0F, 0.0F, 3.0F}},
                           {{"intensity", {1.0F, 2.0F, 3.0F}}}};
    EXPECT_TRUE(writer->append_map(table));
    return folder;
  }
};

TEST_F(ExportVerb, WritesTheMapAndPrintsWhere) {
  const std::string file = path("copy.ply");
  const auto [exit_code, out, err] = run({"export", session(), "--format", "ply", "--out", file});
  ASSERT_EQ(exit_code, 0) << err;
  EXPECT_EQ(out, file + "\n");
  const auto table = read_ply(file);
  ASSERT_TRUE(table) << table.error().message;
  ASSERT_EQ(table->points.size(), 3u);
  EXPECT_EQ(table->points[2], Eigen::Vector3f(0.0F, 0.0F, 3.0F));
  ASSERT_EQ(table->fields.size(), 1u);
  EXPECT_EQ(table->fields[0].values, (std::vector{1.0F, 2.0F, 3.0F}));
}

TEST_F(ExportVerb, WritesTheTrajectory) {
  const std::string file = path("walk.tum");
  const auto [exit_code, out, err] = run({"export", session(), "--format", "tum", "--out", file});
  ASSERT_EQ(exit_code, 0) << err;
  const auto trajectory = read_tum(file);
  ASSERT_TRUE(trajectory) << trajectory.error().message;
  ASSERT_EQ(trajectory->size(), 2u);
  EXPECT_EQ(trajectory->back().T_W_I.translation().x(), 2.0);
}

TEST_F(ExportVerb, PutsTheFileIntoTheSessionUnlessToldOtherwise) {
  const std::string folder = session();
  EXPECT_EQ(run({"export", folder, "--format", "las"}).exit_code, 0);
  EXPECT_THAT(read(folder + "/map.las"), StartsWith("LASF"));
  EXPECT_EQ(run({"export", folder, "--format", "pcd"}).exit_code, 0);
  EXPECT_THAT(read(folder + "/map.pcd"), HasSubstr("FIELDS x y z intensity"));
}

TEST_F(ExportVerb, ReplacesAFileOnlyWhenAsked) {
  const std::string folder = session(), file = write("map.pcd", "precious");
  const auto [exit_code, out, err] = run({"export", folder, "--format", "pcd", "--out", file});
  EXPECT_EQ(exit_code, 2);
  EXPECT_THAT(out, IsEmpty());
  EXPECT_THAT(err, HasSubstr("exists"));
  EXPECT_EQ(read(file), "precious");
  EXPECT_EQ(run({"export", folder, "--format", "pcd", "--out", file, "--overwrite"}).exit_code, 0);
  EXPECT_NE(read(file), "precious");
}

TEST_F(ExportVerb, RefusesWrongInputWithExitCodeTwo) {
  EXPECT_EQ(run({"export", path("absent"), "--format", "ply"}).exit_code, 2);
  EXPECT_EQ(run({"export", session(), "--format", "dxf"}).exit_code, 2);
  EXPECT_THAT(run({"export", path("absent"), "--format", "ply"}).err, HasSubstr("absent"));
}

}  // namespace
}  // namespace pllit
