#include "pllit/thermal/reprojection.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/image_world.hpp"
#include "support/random_states.hpp"

namespace pllit {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector4d;
using test::Random;

struct Scene {
  Rig rig;
  SE3 T_W_I, T_W_I_keyframe;
};

/// Two poses far from the origin that look at much the same place, any way up.
Scene random_scene(Random& random, const Camera& camera) {
  Scene scene;
  scene.rig.camera = camera;
  scene.rig.T_I_C = test::camera_ahead() * pose_from(exp_so3(random.vector(0.1)), random.vector(0.1));
  scene.T_W_I_keyframe = pose_from(random.rotation(), random.vector(100.0));
  scene.T_W_I = scene.T_W_I_keyframe * pose_from(exp_so3(random.vector(0.05)), random.vector(0.4));
  return scene;
}

SE3 moved(const SE3& T_W_I, const Vector6& error) {
  return pose_from(T_W_I.asSO3() * exp_so3(error.head<3>()), T_W_I.translation() + error.tail<3>());
}

Vector3d random_point_C(Random& random, const Camera& camera) {
  return random.uniform(2.0, 15.0) *
         camera.ray({random.uniform(60.0, camera.width - 60.0), random.uniform(60.0, camera.height - 60.0)});
}

PointObservation random_point(Random& random, const Scene& scene) {
  PointObservation point;
  point.p_K_m = random_point_C(random, *scene.rig.camera);
  point.sigma_ray_m = random.uniform(0.01, 0.2);
  point.observed_px = Vector2d(random.uniform(100.0, 500.0), random.uniform(100.0, 400.0));
  return point;
}

std::optional<ImageResidual> residual_of(const Scene& scene, const PointObservation& point) {
  return point_residual(scene.T_W_I, scene.T_W_I_keyframe, point, {.T_I_C = scene.rig.T_I_C}, *scene.rig.camera);
}

SE3 camera_from_keyframe(const Scene& scene) {
  return (scene.T_W_I * scene.rig.T_I_C).inverse() * (scene.T_W_I_keyframe * scene.rig.T_I_C);
}

/// A line before the camera, and a segment a few pixels from where it is seen.
LineObservation random_line(Random& random, const Scene& scene) {
  const SE3 T_W_C = scene.T_W_I * scene.rig.T_I_C;
  const Camera& camera = *scene.rig.camera;
  const Vector3d a_W = T_W_C.act(random_point_C(random, camera)), b_W = T_W_C.act(random_point_C(random, camera));
  const auto near = [&](const Vector3d& p_W) {
    return Vector2d(*camera.project(T_W_C.inverse().act(p_W)) + Vector2d(random.normal(3.0), random.normal(3.0)));
  };
  const SE3 T_K_W = (scene.T_W_I_keyframe * scene.rig.T_I_C).inverse();
  return {.line_K = T_K_W * test::landmark_between(a_W, b_W, 0.02), .start_px = near(a_W), .end_px = near(b_W)};
}

TEST(PointResidual, DerivativesToBothPosesMatchCentralDifferences) {
  Random random(11);
  for (const Camera& camera : {test::thermal_camera(), test::fisheye_camera()})
    for (int i = 0; i < 50; ++i) {
      const Scene scene = random_scene(random, camera);
      const PointObservation point = random_point(random, scene);
      const auto at = residual_of(scene, point);
      if (!at) continue;
      const Matrix2x6 now = test::numerical_jacobian<2, 6>([&](const Vector6& d) {
        Scene other = scene;
        other.T_W_I = moved(other.T_W_I, d);
        return residual_of(other, point)->r_px;
      });
      const Matrix2x6 keyframe = test::numerical_jacobian<2, 6>([&](const Vector6& d) {
        Scene other = scene;
        other.T_W_I_keyframe = moved(other.T_W_I_keyframe, d);
        return residual_of(other, point)->r_px;
      });
      EXPECT_LT((at->J_now - now).norm(), 1e-5 * now.norm());
      EXPECT_LT((at->J_keyframe - keyframe).norm(), 1e-5 * keyframe.norm());
    }
}

TEST(PointResidual, DerivativeToTheCamerasPoseOnTheRigMatchesCentralDifferences) {
  Random random(21);
  for (const Camera& camera : {test::thermal_camera(), test::fisheye_camera()})
    for (int i = 0; i < 50; ++i) {
      const Scene scene = random_scene(random, camera);
      const PointObservation point = random_point(random, scene);
      const auto at = residual_of(scene, point);
      if (!at) continue;
      const Matrix2x6 expected = test::numerical_jacobian<2, 6>([&](const Vector6& d) {
        Scene other = scene;
        other.rig.T_I_C = moved(other.rig.T_I_C, d);
        return residual_of(other, point)->r_px;
      });
      EXPECT_LT((at->J_camera - expected).norm(), 1e-5 * expected.norm() + 1e-6);
    }
}

TEST(PointResidual, DerivativeToTheDepthStretchMatchesCentralDifferences) {
  Random random(23);
  for (const Camera& camera : {test::thermal_camera(), test::fisheye_camera()})
    for (int i = 0; i < 50; ++i) {
      const Scene scene = random_scene(random, camera);
      const PointObservation point = random_point(random, scene);
      const CameraMount mount{.T_I_C = scene.rig.T_I_C, .depth_stretch = 0.02};
      const auto residual = [&](const CameraMount& by) {
        return point_residual(scene.T_W_I, scene.T_W_I_keyframe, point, by, *scene.rig.camera);
      };
      const auto slope = [&](int index) -> Eigen::Vector2d {
        const MountVector little = 1e-6 * MountVector::Unit(index);
        return (residual(boxplus(mount, little))->r_px - residual(boxplus(mount, -little))->r_px) / 2e-6;
      };
      const auto at = residual(mount);
      if (!at) continue;
      const Eigen::Vector2d by_depth = slope(mount_index::depth);
      EXPECT_LT((at->J_depth - by_depth).norm(), 1e-5 * by_depth.norm() + 1e-4);
    }
}

TEST(LineResidual, DerivativeToTheCamerasPoseOnTheRigMatchesCentralDifferences) {
  Random random(22);
  int checked = 0;
  for (const Camera& camera : {test::thermal_camera(), test::fisheye_camera()})
    for (int i = 0; i < 50; ++i) {
      const Scene scene = random_scene(random, camera);
      const LineObservation line = random_line(random, scene);
      const auto at = line_residual(scene.T_W_I, scene.T_W_I_keyframe, line, scene.rig.T_I_C, *scene.rig.camera);
      if (!at) continue;
      const Matrix2x6 expected = test::numerical_jacobian<2, 6>([&](const Vector6& d) {
        Rig rig = scene.rig;
        rig.T_I_C = moved(rig.T_I_C, d);
        return line_residual(scene.T_W_I, scene.T_W_I_keyframe, line, rig.T_I_C, *rig.camera)->residual.r_px;
      });
      EXPECT_LT((at->residual.J_camera - expected).norm(), 1e-4 * expected.norm() + 1e-6);
      ++checked;
    }
  EXPECT_GT(checked, 50);
}

TEST(PointResidual, NoiseIsWhatTheDepthsErrorDoesInTheImage) {
  Random random(12);
  for (int i = 0; i < 50; ++i) {
    const Scene scene = random_scene(random, test::thermal_camera());
    PointObservation point = random_point(random, scene);
    const auto at = residual_of(scene, point);
    if (!at) continue;
    const auto at_depth = [&](double metres) {
      PointObservation other = point;
      other.p_K_m += metres * point.p_K_m.normalized();
      return residual_of(scene, other)->r_px;
    };
    const Vector2d shift = (at_depth(1e-5) - at_depth(-1e-5)) / 2e-5 * point.sigma_ray_m;
    EXPECT_LT((at->model_px2 - shift * shift.transpose()).norm(), 1e-5 * shift.squaredNorm() + 1e-12);
  }
}

TEST(PointResidual, OfAPointThatIsSeenWhereItIsIsZero) {
  Random random(13);
  Scene scene = random_scene(random, test::thermal_camera());
  scene.T_W_I = scene.T_W_I_keyframe;
  const PointObservation point{.p_K_m = Vector3d(0.4, -0.3, 5.0),
                               .sigma_ray_m = 0.05,
                               .observed_px = *scene.rig.camera->project({0.4, -0.3, 5.0})};
  const auto at = residual_of(scene, point);
  EXPECT_LT(at->r_px.norm(), 1e-9);
  EXPECT_LT(at->model_px2.norm(), 1e-9);                                    // without parallax depth does not matter
  EXPECT_LT((at->J_now + at->J_keyframe).norm(), 1e-9 * at->J_now.norm());  // nor does a motion of both
}

TEST(PointResidual, IsNothingBehindTheCamera) {
  Random random(14);
  const Scene scene = random_scene(random, test::thermal_camera());
  const PointObservation point{.p_K_m = Vector3d(0.0, 0.0, -5.0), .observed_px = Vector2d(320.0, 240.0)};
  EXPECT_FALSE(
      point_residual(scene.T_W_I_keyframe, scene.T_W_I_keyframe, point, {.T_I_C = scene.rig.T_I_C}, *scene.rig.camera));
}

TEST(LineResidual, DerivativesToBothPosesMatchCentralDifferences) {
  Random random(15);
  for (const Camera& camera : {test::thermal_camera(), test::fisheye_camera()})
    for (int i = 0; i < 50; ++i) {
      const Scene scene = random_scene(random, camera);
      const LineObservation line = random_line(random, scene);
      const auto at = line_residual(scene.T_W_I, scene.T_W_I_keyframe, line, scene.rig.T_I_C, *scene.rig.camera);
      ASSERT_TRUE(at);
      const Matrix2x6 now = test::numerical_jacobian<2, 6>([&](const Vector6& d) {
        return line_residual(moved(scene.T_W_I, d), scene.T_W_I_keyframe, line, scene.rig.T_I_C, *scene.rig.camera)
            ->residual.r_px;
      });
      const Matrix2x6 keyframe = test::numerical_jacobian<2, 6>([&](const Vector6& d) {
        return line_residual(scene.T_W_I, moved(scene.T_W_I_keyframe, d), line, scene.rig.T_I_C, *scene.rig.camera)
            ->residual.r_px;
      });
      EXPECT_LT((at->residual.J_now - now).norm(), 1e-4 * now.norm());
      EXPECT_LT((at->residual.J_keyframe - keyframe).norm(), 1e-4 * keyframe.norm());
    }
}

TEST(LineResidual, DerivativesToTheLineMatchCentralDifferences) {
  Random random(16);
  for (int i = 0; i < 50; ++i) {
    const Scene scene = random_scene(random, test::thermal_camera());
    const LineObservation line = random_line(random, scene);
    const auto at = line_residual(scene.T_W_I, scene.T_W_I_keyframe, line, scene.rig.T_I_C, *scene.rig.camera);
    ASSERT_TRUE(at);
    const LineLandmark& map = line.line_K;
    const Eigen::Matrix<double, 2, 4> slope = test::numerical_jacobian<2, 4>([&](const Vector4d& shifts) {
      const Vector3d half = map.half_length_m * map.axis.direction;
      const Vector3d a_K = map.centroid - half + shifts[0] * map.u + shifts[1] * map.v;
      const Vector3d b_K = map.centroid + half + shifts[2] * map.u + shifts[3] * map.v;
      LineObservation other = line;
      other.line_K = test::landmark_between(a_K, b_K, 0.02);
      return line_residual(scene.T_W_I, scene.T_W_I_keyframe, other, scene.rig.T_I_C, *scene.rig.camera)->residual.r_px;
    });
    EXPECT_LT((at->J_line - slope).norm(), 1e-4 * slope.norm());
    EXPECT_LT((at->residual.model_px2 - at->J_line * map.covariance_m2 * at->J_line.transpose()).norm(), 1e-9);
  }
}

TEST(LineResidual, SaysNotMuchMoreInManyImagesThanTheLinesOwnDoubtAllows) {
  Random random(23);
  const Scene scene = random_scene(random, test::thermal_camera());
  LineObservation line = random_line(random, scene);
  double information = 0.0;
  for (int image = 1; image <= 200; ++image) {
    line.line_K.sightings = image;
    information += line_residual(scene.T_W_I, scene.T_W_I_keyframe, line, scene.rig.T_I_C, *scene.rig.camera)
                       ->residual.model_px2.inverse()(0, 0);
  }
  line.line_K.sightings = 1;
  const auto once = line_residual(scene.T_W_I, scene.T_W_I_keyframe, line, scene.rig.T_I_C, *scene.rig.camera);
  EXPECT_LT(information, 1.65 * once->residual.model_px2.inverse()(0, 0));
}

TEST(LineResidual, IsThePapersFormulaWithoutDistortion) {
  Random random(17);
  Camera camera = test::thermal_camera();
  camera.k = {};
  camera.fy = camera.fx;
  for (int i = 0; i < 20; ++i) {
    const Scene scene = random_scene(random, camera);
    const LineObservation line = random_line(random, scene);
    const Line3 line_C = camera_from_keyframe(scene) * line.line_K.axis;
    const auto distance_px = [&](const Vector2d& px) {
      const Vector3d s((px.x() - camera.cx) / camera.fx, (px.y() - camera.cy) / camera.fy, 1.0);
      return camera.fx * s.dot(line_C.moment) / line_C.moment.head<2>().norm();
    };
    const auto at = line_residual(scene.T_W_I, scene.T_W_I_keyframe, line, scene.rig.T_I_C, *scene.rig.camera);
    EXPECT_NEAR(at->residual.r_px[0], distance_px(line.start_px), 1e-6);
    EXPECT_NEAR(at->residual.r_px[1], distance_px(line.end_px), 1e-6);
  }
}

TEST(LineResidual, IsTheDistanceInTheDistortedImage) {
  Random random(18);
  for (const Camera& camera : {test::thermal_camera(), test::fisheye_camera()})
    for (int i = 0; i < 20; ++i) {
      const Scene scene = random_scene(random, camera);
      LineObservation line = random_line(random, scene);
      const SE3 T_C_K = camera_from_keyframe(scene);
      // The line's image near its middle by two points a little apart, and a pixel 1.5 px beside it.
      const Vector3d &p_K = line.line_K.centroid, &d = line.line_K.axis.direction;
      const Vector2d middle = *camera.project(T_C_K.act(p_K)), next = *camera.project(T_C_K.act(p_K + 1e-3 * d));
      const Vector2d along = (next - middle).normalized();
      line.start_px = middle + 1.5 * Vector2d(-along.y(), along.x());
      EXPECT_NEAR(std::abs(line_residual(scene.T_W_I, scene.T_W_I_keyframe, line, scene.rig.T_I_C, *scene.rig.camera)
                               ->residual.r_px[0]),
                  1.5, 0.02);
    }
}

TEST(LineResidual, IsNothingOfALineThroughTheCamera) {
  Random random(19);
  const Scene scene = random_scene(random, test::thermal_camera());
  LineObservation line = random_line(random, scene);
  const Vector3d camera_K = camera_from_keyframe(scene).inverse().translation();
  line.line_K = test::landmark_between(camera_K, camera_K + Vector3d(1.0, 2.0, 3.0), 0.02);
  EXPECT_FALSE(line_residual(scene.T_W_I, scene.T_W_I_keyframe, line, scene.rig.T_I_C, *scene.rig.camera));
}

}  // namespace
}  // namespace pllit
