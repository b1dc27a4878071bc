#include "pllit/sim/camera/image_edges.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pllit/sim/camera/edge_lines.hpp"
#include "pllit/sim/camera/heat.hpp"
#include "sim/camera/test_place.hpp"

namespace pllit {
namespace {

using Eigen::Vector2d;
using Kind = ImageEdge::Kind;

/// Looks along y of W, x to the right, z up.
SE3 looking_north() {
  Matrix3d R_W_C;
  R_W_C << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return pose_from(SO3(Eigen::Quaterniond(R_W_C)), Vector3d::Zero());
}

Camera pinhole() { return {.width = 320, .height = 240, .fx = 300.0, .fy = 300.0, .cx = 160.0, .cy = 120.0}; }

std::vector<ImageEdge> edges_seen(const TestPlace& place, const Camera& camera, int threads = 2) {
  RayCaster caster(place, 100.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  const ThermalBand band;
  const Heat heat(place, band, 0.0, 0.003F);
  const Shade shade = [&](auto rays, auto hits, std::size_t samples, std::span<float> kelvin) {
    heat.shade(caster, rays, hits, samples, kelvin);
    for (float& value : kelvin) value /= band.slope(300.0F);
  };
  Arena arena(threads);
  return PlaceEdges(place, 100.0).visible({.camera = camera, .T_W_C = looking_north()}, caster, shade, arena);
}

TestPlace wall_with_box() {
  TestPlace place;
  place.surfaces_ = {plain_surface(0.0F), plain_surface(5.0F)};
  add_rectangle(place.mesh_, {Vector3f(-20, 8, -20), Vector3f(20, 8, -20), Vector3f(20, 8, 20), Vector3f(-20, 8, 20)},
                0);
  add_box(place.mesh_, {-1, 4, -0.5F}, {1, 5, 0.5F}, 1);
  return place;
}

TEST(ImageEdges, ABorderInAWallIsSeenWhereItProjectsAndWithItsContrast) {
  const auto edges = edges_seen(two_walls(0.5, plain_surface(0.0F), plain_surface(3.0F)), pinhole());
  ASSERT_EQ(edges.size(), 1U);  // the wall's outline is outside the image
  EXPECT_EQ(edges[0].kind, Kind::border);
  for (const Vector2d& p : edges[0].line_px) EXPECT_NEAR(p.x(), 160.0 + 300.0 * 0.5 / 4.0, 1e-3);
  EXPECT_GT(edges[0].length_px(), 232.0);
  EXPECT_NEAR(edges[0].contrast, 3.0, 0.2);  // slope at 293 K against 300 K
}

TEST(ImageEdges, OfABoxTheOutlineIsSeenAndNothingBehindIt) {
  const auto edges = edges_seen(wall_with_box(), pinhole());
  ASSERT_EQ(edges.size(), 4U);
  for (const ImageEdge& edge : edges) {
    EXPECT_EQ(edge.kind, Kind::occlusion);
    EXPECT_NEAR(edge.from_W.y(), 4.0, 1e-6);
    for (const Vector2d& p : edge.line_px) {
      const Vector2d off = (p - Vector2d(160.0, 120.0)).cwiseAbs();
      EXPECT_TRUE(std::abs(off.x() - 75.0) < 0.01 || std::abs(off.y() - 37.5) < 0.01) << p.transpose();
    }
  }
}

TEST(ImageEdges, WhatHidesTheMiddleOfAnEdgeLeavesTwo) {
  TestPlace place = wall_with_box();
  add_rectangle(place.mesh_,
                {Vector3f(-0.2F, 2, -3), Vector3f(0.2F, 2, -3), Vector3f(0.2F, 2, 3), Vector3f(-0.2F, 2, 3)}, 0);
  int tops = 0;
  for (const ImageEdge& edge : edges_seen(place, pinhole()))
    tops += std::abs(edge.from_W.z() - 0.5) < 1e-6 && std::abs(edge.to_W.z() - 0.5) < 1e-6;
  EXPECT_EQ(tops, 2);
}

TEST(ImageEdges, DistortionBendsThem) {
  Camera fisheye = pinhole();
  fisheye.distortion = Camera::Distortion::equidistant;
  TestPlace place = two_walls(1.5, plain_surface(0.0F), plain_surface(3.0F));
  const auto edges = edges_seen(place, fisheye);
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_GT(edges[0].line_px.size(), 3U);
  for (double z = -1.2; z < 1.2; z += 0.1) {
    const Vector2d exact = *fisheye.project(Vector3d(1.5, -z, 4.0));
    double nearest_px = 1e9;
    for (std::size_t i = 1; i < edges[0].line_px.size(); ++i) {
      const Vector2d a = edges[0].line_px[i - 1], along = edges[0].line_px[i] - a;
      const double t = std::clamp((exact - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
      nearest_px = std::min(nearest_px, (exact - a - t * along).norm());
    }
    EXPECT_LT(nearest_px, 0.3);
  }
}

TEST(ImageEdges, AreTheSameOnAnyNumberOfThreads) {
  const auto one = edges_seen(room(), pinhole(), 1), four = edges_seen(room(), pinhole(), 4);
  ASSERT_EQ(one.size(), four.size());
  ASSERT_GT(one.size(), 3U);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].from_W, four[i].from_W);
    EXPECT_EQ(one[i].contrast, four[i].contrast);
  }
}

TEST(EdgeLines, PiecesOfOneLineAreJoinedAndACornerIsNot) {
  const auto piece = [](const Vector3d& a, const Vector3d& b) {
    return ImageEdge{.kind = Kind::crease,
                     .from_W = a,
                     .to_W = b,
                     .line_px = {100.0 * a.head<2>(), 100.0 * b.head<2>()},
                     .contrast = 1.0F};
  };
  const auto edges = joined({piece({0, 0, 1}, {1, 0, 1}), piece({3, 0, 1}, {2, 0, 1}), piece({3, 0, 1}, {3, 1, 1}),
                             piece({2, 0, 1}, {1, 0, 1})});
  ASSERT_EQ(edges.size(), 2U);
  EXPECT_NEAR(edges[0].length_px(), 300.0, 1e-9);
  EXPECT_NEAR(edges[1].length_px(), 100.0, 1e-9);
}

TEST(EdgeLines, ALineBesideALongerOneIsADouble) {
  const auto line = [](const Vector2d& a, const Vector2d& b) {
    ImageEdge edge;
    edge.line_px = {a, b};
    return edge;
  };
  const auto edges = without_doubles(
      {line({10, 11}, {60, 11}), line({10, 10}, {90, 10}), line({20, 5}, {20, 60}), line({30, 30}, {35, 30})}, 100, 100,
      10.0);
  ASSERT_EQ(edges.size(), 2U);
  EXPECT_EQ(edges[0].line_px[0], Vector2d(10, 10));
  EXPECT_EQ(edges[1].line_px[0], Vector2d(20, 5));
}

}  // namespace
}  // namespace pllit
