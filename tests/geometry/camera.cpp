#include "pllit/geometry/camera.hpp"

#include <gtest/gtest.h>

#include <random>

namespace pllit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Camera fisheye() {  // Hilti 2022, cam0
  return {.width = 720,
          .height = 540,
          .fx = 351.314,
          .fy = 351.491,
          .cx = 367.852,
          .cy = 253.840,
          .distortion = Camera::Distortion::equidistant,
          .k = {-0.036967, -0.008918, 0.008913, -0.003769, 0.0}};
}

Camera pinhole() {
  return {.width = 640,
          .height = 512,
          .fx = 457.2,
          .fy = 457.9,
          .cx = 323.1,
          .cy = 242.5,
          .distortion = Camera::Distortion::radtan,
          .k = {-0.35, 0.12, 0.001, -0.0005, -0.02}};
}

TEST(Camera, RayUndoesProjectOnTheWholeImage) {
  for (const Camera& camera : {fisheye(), pinhole()}) {
    for (double u = 0.0; u < camera.width; u += 40.0)
      for (double v = 0.0; v < camera.height; v += 40.0) {
        const Vector3d ray = camera.ray({u, v});
        EXPECT_NEAR(ray.norm(), 1.0, 1e-12);
        const auto pixel = camera.project(3.0 * ray);
        ASSERT_TRUE(pixel) << u << " " << v;
        EXPECT_LT((*pixel - Vector2d(u, v)).norm(), 1e-6);
      }
  }
}

TEST(Camera, ProjectsAWorkedExample) {
  // Without distortion: u = 100 * 1/2 + 50 = 100, v = 200 * (-0.5)/2 + 60 = 10.
  const Camera camera{.width = 200, .height = 120, .fx = 100.0, .fy = 200.0, .cx = 50.0, .cy = 60.0};
  EXPECT_LT((*camera.project({1.0, -0.5, 2.0}) - Vector2d(100.0, 10.0)).norm(), 1e-12);
  // Equidistant without coefficients: the radius is f times the angle, here 45 degrees along x.
  Camera wide = camera;
  wide.distortion = Camera::Distortion::equidistant;
  EXPECT_LT((*wide.project({2.0, 0.0, 2.0}) - Vector2d(50.0 + 100.0 * M_PI / 4.0, 60.0)).norm(), 1e-9);
}

TEST(Camera, SlopeOfTheProjectionMatchesCentralDifferences) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> share(0.0, 1.0), range(0.3, 20.0);
  for (const Camera& camera : {fisheye(), pinhole()}) {
    std::vector<Vector3d> points{{0.0, 0.0, 2.0}};
    for (int i = 0; i < 50; ++i)
      points.push_back(range(engine) * camera.ray({share(engine) * camera.width, share(engine) * camera.height}));
    for (const Vector3d& p : points) {
      const auto projection = camera.project_with_slope(p);
      ASSERT_TRUE(projection);
      EXPECT_EQ(projection->pixel_px, *camera.project(p));
      for (int i = 0; i < 3; ++i) {
        const Vector3d d = 1e-6 * p.norm() * Vector3d::Unit(i);
        const Vector2d slope = (*camera.project(p + d) - *camera.project(p - d)) / (2.0 * d.norm());
        EXPECT_LT((projection->J_pixel_point.col(i) - slope).norm(), 1e-6 * projection->J_pixel_point.norm());
      }
    }
  }
}

TEST(Camera, ProjectsNothingFromBehind) {
  EXPECT_FALSE(pinhole().project({0.1, 0.1, -1.0}));
  EXPECT_FALSE(pinhole().project({0.1, 0.1, 0.0}));
}

TEST(Camera, DoesNotFoldRaysBeyondTheModelsReachBackIntoTheImage) {
  // With strong barrel distortion the radial model turns round at some angle; beyond it nothing may be projected.
  const Camera camera = pinhole();
  EXPECT_FALSE(camera.project({5.0, 0.0, 1.0}));
}

}  // namespace
}  // namespace pllit
