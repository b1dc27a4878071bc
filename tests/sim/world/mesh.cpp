#include "pllit/sim/world/mesh.hpp"

#include <gtest/gtest.h>

#include "sim/world/test_place.hpp"

namespace pllit {
namespace {

TEST(Mesh, AppendingKeepsEveryTriangleWhereItWas) {
  Random random(1);
  Mesh both, second;
  testing::add_box(both, Vector3d::Zero(), Vector3d::Ones(), 3);
  testing::add_triangle(second, random.gaussian3(), random.gaussian3(), random.gaussian3(), 5, 7.0F);
  testing::add_triangle(second, random.gaussian3(), random.gaussian3(), random.gaussian3(), 6, 8.0F);
  const Mesh first = both;
  both.append(second);
  ASSERT_EQ(both.triangles.size(), 14U);
  ASSERT_EQ(both.surface.size(), 14U);
  ASSERT_EQ(both.warmer_K.size(), 14U);
  for (std::size_t i = 0; i < 14; ++i) {
    const Mesh& source = i < 12 ? first : second;
    const std::size_t own = i < 12 ? i : i - 12;
    EXPECT_EQ(both.surface[i], source.surface[own]);
    EXPECT_EQ(both.warmer_K[i], source.warmer_K[own]);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(both.vertices[both.triangles[i][k]], source.vertices[source.triangles[own][k]]);
  }
}

TEST(Actor, MovesEvenlyBetweenWaypointsAndRestsBeforeAndAfter) {
  const SE3 first = pose_from(exp_so3(Vector3d(0.0, 0.0, 0.2)), Vector3d(1.0, 2.0, 3.0));
  const SE3 second = pose_from(exp_so3(Vector3d(0.0, 0.0, 1.0)), Vector3d(5.0, 2.0, -1.0));
  const Actor actor{.name = "cart",
                    .mesh_O = {},
                    .path = {{.at_s = 2.0, .T_W_O = first}, {.at_s = 4.0, .T_W_O = second}},
                    .heating = {}};
  const auto distance = [](const SE3& a, const SE3& b) { return (a - b).coeffs().norm(); };
  EXPECT_LT(distance(actor.pose(-1.0), first), 1e-12);
  EXPECT_LT(distance(actor.pose(2.0), first), 1e-12);
  EXPECT_LT(distance(actor.pose(4.0), second), 1e-12);
  EXPECT_LT(distance(actor.pose(99.0), second), 1e-12);
  const SE3 quarter = pose_from(exp_so3(Vector3d(0.0, 0.0, 0.4)), Vector3d(2.0, 2.0, 2.0));
  EXPECT_LT(distance(actor.pose(2.5), quarter), 1e-12);
}

}  // namespace
}  // namespace pllit
