#include "pllit/thermal/alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

namespace pllit {
namespace {

using Eigen::Vector2f;

Camera camera() { return {.width = 200, .height = 160, .fx = 240, .fy = 240, .cx = 99.5, .cy = 79.5}; }

/// A painted plane in W.
struct Wall {
  Vector3d point_W{0.0, 0.0, 5.0}, normal_W = Vector3d(0.3, -0.2, -1.0).normalized();
  double scale = 1.0;   ///< of the pattern
  double across = 1.0;  ///< how much of the pattern varies along y; 0: upright stripes only

  double grey(const Vector3d& p_W) const {
    const double x = p_W.x() / scale, y = across * p_W.y() / scale;
    return 110.0 + 30.0 * std::sin(9.0 * x + 4.0 * y) + 25.0 * std::sin(14.0 * y - 5.0 * x) + 20.0 * std::sin(21.0 * x);
  }
  Vector3d hit(const SE3& T_W_C, const Eigen::Vector2d& pixel) const {
    const Vector3d ray_W = T_W_C.rotation() * camera().ray(pixel);
    const double range_m = (point_W - T_W_C.translation()).dot(normal_W) / ray_W.dot(normal_W);
    return T_W_C.translation() + range_m * ray_W;
  }
};

cv::Mat seen(const Wall& wall, const SE3& T_W_C, double gain = 1.0, double bias = 0.0) {
  cv::Mat image(camera().height, camera().width, CV_8UC1);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      image.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(gain * wall.grey(wall.hit(T_W_C, Eigen::Vector2d(u, v))) + bias);
  return image_for_alignment(image);
}

/// A keyframe at the origin with points on a grid.
Keyframe keyframe_of(const Wall& wall) {
  Keyframe keyframe;
  keyframe.image = seen(wall, SE3::Identity());
  for (int v = 30; v <= 130; v += 20)
    for (int u = 30; u <= 170; u += 20) {
      const Eigen::Vector2d pixel(u, v);
      keyframe.features.points_px.emplace_back(pixel.cast<float>());
      const double range_m = wall.hit(SE3::Identity(), pixel).norm();
      keyframe.depths.push_back(FeatureDepth{.range_m = range_m, .sigma_m = 0.02, .normal_C = wall.normal_W});
    }
  return keyframe;
}

const SE3 nearer = pose_from(exp_so3({0.02, -0.03, 0.15}), {0.3, 0.1, 0.9});

struct Outcome {
  int tried = 0, found = 0;
  double worst_px = 0.0;
};

/// Each point that shows well within the image now, sought from a pixel and a half off.
Outcome outcome(const Keyframe& keyframe, const Wall& wall, const cv::Mat& now, const AlignConfig& config = {}) {
  Outcome out;
  for (std::size_t i = 0; i < keyframe.depths.size(); ++i) {
    const Vector3d ray_K = camera().ray(keyframe.features.points_px[i].cast<double>());
    const Vector3d p_W = wall.hit(SE3::Identity(), keyframe.features.points_px[i].cast<double>());
    const auto truth_px = camera().project(nearer.inverse().act(p_W));
    if (!truth_px || truth_px->minCoeff() < 20 || truth_px->x() > 180 || truth_px->y() > 140) continue;
    ++out.tried;
    const Vector2f begin_px = truth_px->cast<float>() + Vector2f(1.2F, -0.9F);
    const auto at_px = aligned(now, keyframe, i, ray_K, begin_px, nearer.inverse(), camera(), config);
    if (!at_px) continue;
    ++out.found;
    out.worst_px = std::max(out.worst_px, (at_px->cast<double>() - *truth_px).norm());
  }
  return out;
}

TEST(Alignment, FindsPointsOfASlantingWallToAFractionOfAPixelFromNearerAndTurned) {
  const Wall wall;
  const Outcome all = outcome(keyframe_of(wall), wall, seen(wall, nearer));
  ASSERT_GE(all.tried, 20);
  EXPECT_GE(all.found, 0.95 * all.tried);
  EXPECT_LT(all.worst_px, 0.15);
}

TEST(Alignment, DoesNotMindGainAndBias) {
  const Wall wall;
  const Outcome all = outcome(keyframe_of(wall), wall, seen(wall, nearer, 0.5, 60.0));
  EXPECT_GE(all.found, 0.95 * all.tried);
  EXPECT_LT(all.worst_px, 0.15);
}

TEST(Alignment, SaysNothingOfStripesAlongWhichAPointMayLieAnywhere) {
  const Wall stripes{.across = 0.0};
  EXPECT_EQ(outcome(keyframe_of(stripes), stripes, seen(stripes, nearer)).found, 0);
}

TEST(Alignment, SaysNothingOfWhatLooksOtherwise) {
  const Wall wall;
  const Keyframe keyframe = keyframe_of(wall);
  EXPECT_EQ(outcome(keyframe, wall, cv::Mat(160, 200, CV_8UC1, cv::Scalar(90))).found, 0);
  const cv::Mat inverse = cv::Scalar(255) - seen(wall, nearer);
  EXPECT_EQ(outcome(keyframe, wall, inverse).found, 0);
  const Wall other{.scale = 1.7};
  EXPECT_LE(outcome(keyframe, wall, seen(other, nearer)).found, 2);
}

TEST(Alignment, NeverReadsBeyondAnImage) {
  const Wall wall;
  Keyframe keyframe = keyframe_of(wall);
  const cv::Mat now = seen(wall, nearer);
  for (const Vector2f& at : {Vector2f(0, 0), Vector2f(199, 159), Vector2f(3, 80), Vector2f(100, 157)}) {
    keyframe.features.points_px[0] = at;
    const Vector3d ray_K = camera().ray(at.cast<double>());
    keyframe.depths[0]->range_m = wall.hit(SE3::Identity(), at.cast<double>()).norm();
    EXPECT_FALSE(aligned(now, keyframe, 0, ray_K, at, SE3::Identity(), camera(), {}));
    EXPECT_FALSE(aligned(now, keyframe, 0, ray_K, Vector2f(-5e3F, 1e9F), SE3::Identity(), camera(), {}));
  }
}

TEST(Alignment, FindsKnownPointsThatNoFeatureWasMatchedWithAndKeepsMatchesThatItCannotAlign) {
  const Wall wall;
  Keyframe keyframe = keyframe_of(wall);
  std::vector<Vector3d> rays_K;
  for (const Vector2f& at : keyframe.features.points_px) rays_K.push_back(camera().ray(at.cast<double>()));
  const cv::Mat now = seen(wall, nearer), blank(160, 200, CV_8UC1, cv::Scalar(90));
  const SE3 T_C_K = nearer.inverse();
  const std::vector<PointTrack> found = tracked_points(now, {}, keyframe, rays_K, {}, T_C_K, camera(), {});
  EXPECT_GE(found.size(), 20U);
  for (const PointTrack& track : found) EXPECT_TRUE(track.aligned);

  Features one;
  one.points_px = {Vector2f(77.0F, 66.0F)};
  const PointMatch match{.reference = 3, .current = 0, .line_px = 1.5};
  const std::vector<PointTrack> kept = tracked_points(blank, one, keyframe, rays_K, {&match, 1}, T_C_K, camera(), {});
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_FALSE(kept[0].aligned);
  EXPECT_EQ(kept[0].reference, 3);
  EXPECT_EQ(kept[0].at_px, one.points_px[0]);
  EXPECT_EQ(kept[0].line_px, 1.5);
}

}  // namespace
}  // namespace pllit
