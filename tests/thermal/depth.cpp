#include "pllit/thermal/depth.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "pllit/thermal/near_surface.hpp"
#include "support/image_world.hpp"
#include "support/random_states.hpp"

namespace pllit {
namespace {

using Eigen::Vector2d;
using test::Random;

/// A rectangle facing the camera at a depth: from x_min to x_max and y_min to y_max, tilted about the vertical.
struct Panel {
  double z, x_min, x_max, y_min, y_max, slope = 0.0;  ///< z grows by slope x

  std::optional<double> range_m(const Vector3d& ray, const Vector3d& from = Vector3d::Zero()) const {
    const double s = (z + slope * from.x() - from.z()) / (ray.z() - slope * ray.x());
    const Vector3d p = from + s * ray;
    const bool inside = s > 0.0 && p.x() >= x_min && p.x() <= x_max && p.y() >= y_min && p.y() <= y_max;
    return inside ? std::optional(s) : std::nullopt;
  }
};

double nearest_m(const std::vector<Panel>& panels, const Vector3d& ray, const Vector3d& from = Vector3d::Zero()) {
  double nearest = 1e9;
  for (const Panel& panel : panels)
    if (const auto range = panel.range_m(ray, from)) nearest = std::min(nearest, *range);
  return nearest;
}

struct Lidar {
  double spacing_deg = 0.3, noise_m = 0.02;
  Vector3d at_C = Vector3d::Zero();
  bool mixed_pixels = false;  ///< returns half way between near and far where a beam hits both
};

std::vector<Vector3f> scan(const std::vector<Panel>& panels, const Lidar& lidar, Random& random) {
  std::vector<Vector3f> points;
  const double step = lidar.spacing_deg * M_PI / 180.0;
  for (double azimuth = -0.7; azimuth < 0.7; azimuth += step)
    for (double elevation = -0.6; elevation < 0.6; elevation += step) {
      const auto ray_at = [](double a, double e) {
        return Vector3d(std::sin(a), std::tan(e), std::cos(a)).normalized();
      };
      const double a = azimuth + random.normal(0.2 * step), e = elevation + random.normal(0.2 * step);
      double range = nearest_m(panels, ray_at(a, e), lidar.at_C);
      if (lidar.mixed_pixels) {
        const double beside = nearest_m(panels, ray_at(a + 0.0015, e), lidar.at_C);
        if (std::abs(beside - range) > 0.3) range += random.uniform(0.0, 1.0) * (beside - range);
      }
      if (range > 1e8) continue;
      points.push_back((lidar.at_C + (range + random.normal(lidar.noise_m)) * ray_at(a, e)).cast<float>());
    }
  return points;
}

const std::vector<Panel> wall{{.z = 6.0, .x_min = -20, .x_max = 20, .y_min = -20, .y_max = 20, .slope = 0.4}};
const std::vector<Panel> panel_before_wall{{.z = 3.0, .x_min = -0.8, .x_max = 0.5, .y_min = -0.7, .y_max = 0.7},
                                           {.z = 5.0, .x_min = -20, .x_max = 20, .y_min = -20, .y_max = 20}};

TEST(FeatureDepths, OnASlantingWallErrByWhatTheyClaim) {
  Random random(41);
  const Camera camera = test::thermal_camera();
  for (const double spacing : {0.15, 0.4, 0.8}) {
    double squares = 0.0, sum = 0.0;
    int count = 0;
    for (int round = 0; round < 5; ++round) {
      const auto points = scan(wall, {.spacing_deg = spacing}, random);
      const DepthImage depths(points, SE3::Identity(), camera, {});
      for (int i = 0; i < 200; ++i) {
        const Vector2d px(random.uniform(20.0, 620.0), random.uniform(20.0, 490.0));
        const auto depth = depths.at(px);
        if (!depth) continue;
        ++count;
        const double error = (depth->range_m - nearest_m(wall, camera.ray(px))) / depth->sigma_m;
        squares += error * error;
        sum += error;
        EXPECT_LT(std::abs(error), 4.0);
        EXPECT_NEAR(depth->normal_C.norm(), 1.0, 1e-9);
        EXPECT_LT(depth->normal_C.dot(camera.ray(px)), 0.0);
      }
    }
    EXPECT_GT(count, 900) << spacing;
    EXPECT_LT(squares / count, 1.2) << spacing;  // far less where many neighbours average what may be common to them
    EXPECT_LT(std::abs(sum / count), 0.15) << spacing;
  }
}

TEST(FeatureDepths, OfAPanelsEdgeAreThePanels) {
  Random random(42);
  const Camera camera = test::thermal_camera();
  const auto points = scan(panel_before_wall, {.spacing_deg = 0.25, .mixed_pixels = true}, random);
  const DepthImage depths(points, SE3::Identity(), camera, {});
  int on_edge = 0, found = 0;
  for (double y = -0.6; y < 0.6; y += 0.02)
    for (const double x : {-0.8, 0.5}) {
      const auto px = camera.project({x, y, 3.0});
      ++on_edge;
      const auto depth = depths.at(*px);
      if (!depth) continue;
      ++found;
      EXPECT_NEAR(depth->range_m, Vector3d(x, y, 3.0).norm(), 0.06);
    }
  EXPECT_GT(found, on_edge / 2);
}

TEST(FeatureDepths, LieBetweenTwoSurfacesLessThanOnceInAThousand) {
  Random random(43);
  const Camera camera = test::thermal_camera();
  for (const bool mixed : {false, true}) {
    const auto points = scan(panel_before_wall, {.spacing_deg = 0.3, .mixed_pixels = mixed}, random);
    const DepthImage depths(points, SE3::Identity(), camera, {});
    int found = 0, between = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vector2d px(random.uniform(180.0, 420.0), random.uniform(120.0, 360.0));
      const auto depth = depths.at(px);
      if (!depth) continue;
      ++found;
      const double z = depth->range_m * camera.ray(px).z();
      if (z > 3.1 && z < 4.9) ++between;
    }
    EXPECT_GT(found, 3000);
    EXPECT_LT(between, found / 1000) << (mixed ? "with" : "without") << " mixed pixels";
  }
}

TEST(FeatureDepths, OfAHiddenSurfaceDoNotShineThrough) {
  Random random(44);
  const Camera camera = test::thermal_camera();
  // A LiDAR to the side sees much of the wall that the panel hides from the camera, and the panel is sparse.
  auto points = scan({panel_before_wall[1]}, {.spacing_deg = 0.2, .at_C = Vector3d(1.5, 0.0, 0.0)}, random);
  const auto panel = scan({panel_before_wall[0]}, {.spacing_deg = 0.35}, random);
  points.insert(points.end(), panel.begin(), panel.end());
  const DepthImage depths(points, SE3::Identity(), camera, {});
  int found = 0, through = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto px = camera.project({random.uniform(-0.7, 0.4), random.uniform(-0.6, 0.6), 3.0});
    const auto depth = depths.at(*px);
    if (!depth) continue;
    ++found;
    if (depth->range_m * camera.ray(*px).z() > 3.2) ++through;
  }
  EXPECT_GT(found, 900);
  EXPECT_LE(through, 2);
}

TEST(FeatureDepths, AreNothingWhereTheLidarSawNothing) {
  const Camera camera = test::thermal_camera();
  EXPECT_FALSE(DepthImage(std::vector<Vector3f>{}, SE3::Identity(), camera, {}).at({320.0, 240.0}));
  const std::vector<Vector3f> four(4, Vector3f(0.0F, 0.0F, 4.0F));
  EXPECT_FALSE(DepthImage(four, SE3::Identity(), camera, {}).at({320.0, 240.0}));
  const std::vector<Vector3f> behind(100, Vector3f(0.0F, 0.0F, -4.0F)), broken(100, Vector3f::Constant(NAN));
  EXPECT_TRUE(DepthImage(behind, SE3::Identity(), camera, {}).points_C().empty());
  EXPECT_TRUE(DepthImage(broken, SE3::Identity(), camera, {}).points_C().empty());
}

TEST(FeatureDepths, AreNothingOnASurfaceSeenTooFlatly) {
  Random random(45);
  const Camera camera = test::thermal_camera();
  const std::vector<Panel> flat{{.z = 6.0, .x_min = -20, .x_max = 20, .y_min = -20, .y_max = 20, .slope = 8.0}};
  const DepthImage depths(scan(flat, {.spacing_deg = 0.15, .noise_m = 0.0}, random), SE3::Identity(), camera, {});
  EXPECT_FALSE(depths.at(Vector2d(camera.cx, camera.cy)));  // 83 degrees from the normal
}

TEST(FeatureDepths, DoNotDependOnTheFrameThatPointsComeIn) {
  Random random(46);
  const Camera camera = test::thermal_camera();
  const auto points_C = scan(wall, {}, random);
  const SE3 T_P_C = pose_from(random.rotation(), random.vector(10.0));
  std::vector<Vector3f> points_P;
  for (const Vector3f& p : points_C) points_P.push_back(T_P_C.act(p.cast<double>()).cast<float>());
  const DepthImage here(points_C, SE3::Identity(), camera, {}), there(points_P, T_P_C.inverse(), camera, {});
  int both = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector2d px(random.uniform(20.0, 620.0), random.uniform(20.0, 490.0));
    const auto a = here.at(px), b = there.at(px);
    if (!a || !b) continue;
    ++both;
    EXPECT_NEAR(a->range_m, b->range_m, 0.03);  // a point may change its bin
  }
  EXPECT_GT(both, 250);
}

/// The neighbours that a search through all points finds.
std::optional<FeatureDepth> naive_depth(const std::vector<Vector3f>& points_C, const Vector2d& px, const Camera& camera,
                                        const DepthConfig& config) {
  const Vector3d ray = camera.ray(px);
  const float reach = static_cast<float>(std::sin(config.reach_deg * M_PI / 180.0));
  std::vector<RaysNeighbour> all;
  for (const Vector3f& p : points_C) {
    const float range = p.norm(), angle2 = (p / range - ray.cast<float>()).squaredNorm();
    if (angle2 <= reach * reach) all.push_back({p, range, angle2});
  }
  std::ranges::sort(all, {}, &RaysNeighbour::angle2);
  // The patch is as wide as the nearest surface close to the ray asks for.
  std::vector<RaysNeighbour> kept;
  float nearest = 1e9F;
  const float clear = static_cast<float>(config.clear_deg * M_PI / 180.0);
  for (const RaysNeighbour& point : all)
    if (point.angle2 <= clear * clear) nearest = std::min(nearest, point.range_m);
  const float patch = std::max(static_cast<float>(config.patch_m) / nearest, clear);
  for (const RaysNeighbour& point : all)
    if (kept.size() < 5 || point.angle2 <= patch * patch) kept.push_back(point);
  std::ranges::sort(kept, {}, &RaysNeighbour::range_m);
  return depth_on_near_surface(ray, kept, config, 0.5 * (camera.fx + camera.fy));
}

TEST(FeatureDepths, AreThoseOfASearchThroughAllPoints) {
  Random random(47);
  for (const Camera& camera : {test::thermal_camera(), test::fisheye_camera()})
    for (const double spacing : {0.2, 0.7}) {
      const auto points = scan(wall, {.spacing_deg = spacing}, random);
      const DepthImage depths(points, SE3::Identity(), camera, {});
      const auto seen = depths.points_C();
      int found = 0;
      for (int i = 0; i < 200; ++i) {
        const Vector2d px(random.uniform(0.0, camera.width - 1.0), random.uniform(0.0, camera.height - 1.0));
        const auto fast = depths.at(px), naive = naive_depth(seen, px, camera, {});
        ASSERT_EQ(fast.has_value(), naive.has_value());
        if (!fast) continue;
        ++found;
        // The neighbours' coordinates are floats, summed in another order.
        EXPECT_NEAR(fast->range_m, naive->range_m, 1e-5);
        EXPECT_NEAR(fast->sigma_m, naive->sigma_m, 1e-5);
      }
      EXPECT_GT(found, 20);
    }
}

TEST(PointsAlong, ALineOnAPanelsEdgeLieOnThatEdge) {
  Random random(48);
  const Camera camera = test::thermal_camera();
  const auto points = scan(panel_before_wall, {.spacing_deg = 0.25, .mixed_pixels = true}, random);
  const DepthImage depths(points, SE3::Identity(), camera, {});
  const LineSegment line{.start_px = camera.project({0.5, -0.6, 3.0})->cast<float>(),
                         .end_px = camera.project({0.5, 0.6, 3.0})->cast<float>()};
  const auto along = points_along(line, depths, camera);
  ASSERT_GT(along.size(), 15);
  Vector3d mean = Vector3d::Zero();
  for (const EdgePoint& point : along) {
    EXPECT_NEAR(point.sigma_across_m, point.p_C.norm() / camera.fx, 1e-3);
    EXPECT_NEAR(std::abs(point.slide_C_m.x()), 3.0 / camera.fx, 1e-3) << "the panel faces the camera";
    EXPECT_NEAR(point.slide_C_m.z(), 0.0, 3e-3);
    mean += point.p_C / static_cast<double>(along.size());
  }
  EXPECT_NEAR(mean.x(), 0.5, 0.01);
  EXPECT_NEAR(mean.z(), 3.0, 0.02);
}

}  // namespace
}  // namespace pllit
