#include "pllit/sim/world/mesh_edges.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "sim/world/test_place.hpp"

namespace pllit {
namespace {

double total_length_m(const std::vector<MeshEdge>& edges) {
  double sum_m = 0.0;
  for (const auto& [from, to] : edges) sum_m += static_cast<double>((to - from).norm());
  return sum_m;
}

TEST(MeshEdges, ABoxHasItsTwelveAndNotTheDiagonalsOfItsSides) {
  Mesh mesh;
  testing::add_box(mesh, Vector3d::Zero(), Vector3d(1.0, 2.0, 3.0), 0);
  const auto edges = straight_edges(mesh);
  EXPECT_EQ(edges.size(), 12U);
  EXPECT_NEAR(total_length_m(edges), 4.0 * 6.0, 1e-5);
}

TEST(MeshEdges, PanelsOfOneKindThatContinueEachOtherHaveOneOutline) {
  Mesh mesh;
  for (int i = 0; i < 5; ++i) testing::add_sheet(mesh, {2.0 * i, 0.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, 3.0}, 4);
  const auto edges = straight_edges(mesh);
  EXPECT_EQ(edges.size(), 4U);
  EXPECT_NEAR(total_length_m(edges), 26.0, 1e-4);
}

TEST(MeshEdges, MaterialAndWarmthDivideAPlane) {
  Mesh mesh;
  testing::add_sheet(mesh, {0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, 3.0}, 4);
  testing::add_sheet(mesh, {2.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, 3.0}, 5);
  testing::add_sheet(mesh, {4.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, 3.0}, 5);
  mesh.warmer_K[4] = mesh.warmer_K[5] = 0.5F;
  EXPECT_NEAR(total_length_m(straight_edges(mesh)), 2.0 * 6.0 + 4.0 * 3.0, 1e-4);
}

TEST(MeshEdges, AFinelyRoundedTubeHasNoneAlongItself) {
  const auto tube = [](int sides) {
    Mesh mesh;
    for (int i = 0; i < sides; ++i) {
      const auto corner = [&](int k) {
        const double turn = 2.0 * std::numbers::pi * k / sides;
        return Vector3d(std::cos(turn), std::sin(turn), 0.0);
      };
      testing::add_sheet(mesh, corner(i), corner(i + 1) - corner(i), {0.0, 0.0, 5.0}, 0);
    }
    return straight_edges(mesh);
  };
  const auto is_long = [](const MeshEdge& edge) { return std::abs(edge.to.z() - edge.from.z()) > 4.9F; };
  EXPECT_EQ(std::ranges::count_if(tube(150), is_long), 0);
  EXPECT_EQ(std::ranges::count_if(tube(12), is_long), 12);
}

}  // namespace
}  // namespace pllit
