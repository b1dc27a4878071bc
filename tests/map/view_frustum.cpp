#include "pllit/map/view_frustum.hpp"

#include <gtest/gtest.h>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

Camera camera(Camera::Distortion distortion) {
  const bool fisheye = distortion == Camera::Distortion::equidistant;
  return {.width = 640,
          .height = 512,
          .fx = fisheye ? 260.0 : 420.0,
          .fy = fisheye ? 261.0 : 422.0,
          .cx = 310.0,
          .cy = 262.0,
          .distortion = distortion,
          .k = {fisheye ? -0.02 : -0.3, 0.05, 0.0, 0.0, 0.0}};
}

TEST(ViewFrustum, HoldsWhatAnImageShowsAndHardlyMore) {
  Random random(3);
  for (const auto distortion : {Camera::Distortion::radtan, Camera::Distortion::equidistant}) {
    const Camera shown_by = camera(distortion);
    const SE3 T_W_C = pose_from(random.rotation(), random.vector(5.0));
    const ViewFrustum view = view_frustum(T_W_C, shown_by, 8.0);
    int held = 0, shown = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vector3d p_C = random.uniform(0.5, 10.0) * random.vector().normalized();
      const auto pixel_px = shown_by.project(p_C);
      const bool in_image = pixel_px && p_C.norm() < 8.0 && pixel_px->x() >= 0.0 && pixel_px->y() >= 0.0 &&
                            pixel_px->x() <= shown_by.width - 1.0 && pixel_px->y() <= shown_by.height - 1.0;
      const bool is_held = view.contains(T_W_C.act(p_C));
      EXPECT_TRUE(is_held || !in_image) << p_C.transpose();
      held += is_held ? 1 : 0;
      shown += in_image ? 1 : 0;
    }
    EXPECT_GT(shown, 1000);
    EXPECT_LT(held, distortion == Camera::Distortion::radtan ? 1.4 * shown : 2.0 * shown);
  }
}

TEST(ViewFrustum, MayShowEveryBallOfWhichItHoldsAPoint) {
  Random random(4);
  const ViewFrustum view = view_frustum(SE3::Identity(), camera(Camera::Distortion::radtan), 8.0);
  int missed = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p_W = random.vector(4.0), middle_W = p_W + random.uniform(0.0, 1.0) * random.vector().normalized();
    EXPECT_TRUE(view.may_show(middle_W, 1.0) || !view.contains(p_W));
    missed += view.may_show(middle_W, 1.0) ? 0 : 1;
  }
  EXPECT_GT(missed, 1000);
}

TEST(ViewFrustum, GrowsToAllSidesByItsMargin) {
  Camera shown_by = camera(Camera::Distortion::radtan);
  shown_by.k = {};  // so that the sides are planes
  const ViewFrustum narrow = view_frustum(SE3::Identity(), shown_by, 8.0, 0.0),
                    wide = view_frustum(SE3::Identity(), shown_by, 8.0, 0.2);
  for (const Eigen::Vector2d& edge_px : {Eigen::Vector2d(0.0, 256.0), {639.0, 256.0}, {320.0, 0.0}, {320.0, 511.0}}) {
    const Vector3d ray = shown_by.ray(edge_px), out = (ray - ray.z() * Vector3d::UnitZ()).normalized();
    const auto turned = [&](double by_rad) -> Vector3d {
      const double angle = std::acos(ray.z()) + by_rad;
      return std::cos(angle) * Vector3d::UnitZ() + std::sin(angle) * out;
    };
    EXPECT_FALSE(narrow.contains(turned(0.1)));
    EXPECT_TRUE(wide.contains(turned(0.1)));
    EXPECT_FALSE(wide.contains(turned(0.3)));
  }
}

}  // namespace
}  // namespace pllit
