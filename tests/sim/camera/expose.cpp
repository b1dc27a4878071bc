#include "pllit/sim/camera/expose.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <opencv2/core.hpp>

#include "pllit/sim/camera/patches.hpp"
#include "sim/camera/test_place.hpp"

namespace pllit {
namespace {

const CameraPath kAtRest = [](Time) { return looking_along_y(); };

/// The left wall is 0, the right one 1.
cv::Mat of_two_walls(const Sampling& sampling, std::uint64_t seed, std::atomic<int>* count = nullptr) {
  const TestPlace place = two_walls(0.005, plain_surface(0.0F), plain_surface(1.0F));
  RayCaster caster(place, 50.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  const Shade shade = [&](auto, std::span<const Hit> hits, std::size_t, std::span<float> values) {
    for (std::size_t i = 0; i < hits.size(); ++i) values[i] = static_cast<float>(hits[i].surface);
    if (count) *count += static_cast<int>(hits.size());
  };
  Arena arena(2);
  const auto poses = open_shutter(kAtRest, Time{}, std::chrono::milliseconds(1));
  return expose(RayTable(small_camera()), caster, poses, sampling, seed, shade, arena);
}

TEST(Expose, PixelsAtAnEdgeGetMoreSamplesAndNoOthersDo) {
  std::atomic<int> count = 0;
  of_two_walls({.first = 4, .more = 12, .spread = 0.5F}, 1, &count);
  const int pixels = small_camera().width * small_camera().height, rows = small_camera().height;
  EXPECT_GE(count, 4 * pixels + 12 * rows);
  EXPECT_LE(count, 4 * pixels + 3 * 12 * rows);
}

TEST(Expose, MoreSamplesBringPixelsOnAnEdgeNearerToTheirShare) {
  const auto scatter = [](int more) {
    double squares = 0.0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const cv::Mat image = of_two_walls({.first = 4, .more = more, .spread = 0.5F}, seed);
      const Eigen::Vector2d edge = *small_camera().project({0.005, 0.0, 4.0});
      const int column = static_cast<int>(std::floor(edge.x() + 0.5));
      const double share = column + 0.5 - edge.x();
      for (int row = 0; row < image.rows; ++row)
        squares += std::pow(static_cast<double>(image.at<float>(row, column)) - share, 2);
    }
    return squares;
  };
  EXPECT_LT(scatter(12), 0.5 * scatter(0));
}

TEST(Patches, HoldTheSamplesOfOnePixelOnOneSurface) {
  const TestPlace place = two_walls(0.0, plain_surface(0.0F), plain_surface(1.0F));
  RayCaster caster(place, 50.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  std::vector<Ray> rays;
  for (const double x : {-0.01, 0.01, -0.02, 0.02, 0.03, 0.04, 0.05, 0.06})
    rays.push_back({Vector3d::Zero(), Vector3d(x, 1.0, 0.0).normalized()});
  std::vector<Hit> hits;
  for (const Ray& ray : rays) hits.push_back(caster.cast(ray));
  const Patches patches(rays, hits, 4);
  const std::vector<std::size_t> expected{0, 1, 0, 1, 4, 4, 4, 4};
  for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(patches.first(i), expected[i]);
}

TEST(Patches, TellSunFromShadowWhereAsked) {
  TestPlace place = two_walls(0.0, plain_surface(0.0F), plain_surface(1.0F));
  add_box(place.mesh_, {0.5F, -1, 2}, {1.5F, 3, 2.5F}, 0);  // between the sun and the second ray's place
  RayCaster caster(place, 50.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  const Vector3d at_left = Vector3d(-1.0, 4.0, 0.0).normalized(), at_right = Vector3d(1.0, 4.0, 0.0).normalized();
  const std::vector<Ray> rays{{Vector3d::Zero(), at_left}, {Vector3d::Zero(), at_right}, {Vector3d::Zero(), at_left}};
  std::vector<Hit> hits;
  for (const Ray& ray : rays) hits.push_back(caster.cast(ray));
  Patches patches(rays, hits, 1);
  int asked = 0;
  patches.seek_sun(caster, Vector3f(0.0F, -1.0F, 1.0F).normalized(), [&](auto&, auto&) { return asked++ < 2; });
  EXPECT_TRUE(patches.in_sun(0));
  EXPECT_FALSE(patches.in_sun(1));
  EXPECT_FALSE(patches.in_sun(2));
}

}  // namespace
}  // namespace pllit
