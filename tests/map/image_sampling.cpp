#include "pllit/map/image_sampling.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <utility>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

Camera camera() {
  return {.width = 320,
          .height = 256,
          .fx = 300.0,
          .fy = 305.0,
          .cx = 158.0,
          .cy = 130.0,
          .k = {-0.28, 0.09, 0.0004, -0.0003, 0.0}};
}

/// Intensity that tells where it was read; linear, so that bilinear reading is exact.
double pattern(double x, double y) { return 3.0 * x - 2.0 * y + 7.0; }

ImagePair pattern_images() {
  ImagePair images{cv::Mat(camera().height, camera().width, CV_32FC1),
                   cv::Mat(camera().height, camera().width, CV_8UC1)};
  for (int row = 0; row < camera().height; ++row)
    for (int column = 0; column < camera().width; ++column) {
      images.calibrated.at<float>(row, column) = static_cast<float>(pattern(column, row));
      images.raw.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>((column + 3 * row) % 256);
    }
  return images;
}

/// Points of a wall 5 m ahead and of panels before it, a little rough.
SurfacePoints clutter(Random& random, int count) {
  SurfacePoints points;
  for (int i = 0; i < count; ++i) {
    const double depth = i % 3 == 0 ? 5.0 : i % 3 == 1 ? 2.0 + 0.5 * std::floor(random.uniform(0.0, 4.0)) : 0.5;
    points.points_W.emplace_back(static_cast<float>(random.uniform(-3.0, 3.0)),
                                 static_cast<float>(random.uniform(-3.0, 3.0)),
                                 static_cast<float>(depth + random.normal(0.01)));
    points.fresh.push_back(i % 4 == 0 ? 1 : 0);
  }
  return points;
}

/// The obvious twin: every point against every other.
std::vector<std::size_t> naive(const SurfacePoints& points, const SE3& T_W_C, const SamplingConfig& config) {
  struct Seen {
    std::size_t index;
    int column, row;
    float range_m;
    bool in_sight = true, fresh = false;
  };
  std::vector<Seen> seen;
  for (std::size_t i = 0; i < points.points_W.size(); ++i) {
    const Vector3d p_C = T_W_C.inverse().act(points.points_W[i].cast<double>());
    const auto pixel = camera().project(p_C);
    if (p_C.z() < 0.1 * p_C.norm() || p_C.norm() < config.min_range_m || p_C.norm() > config.max_range_m || !pixel)
      continue;
    const double b = config.border_px;
    if (pixel->x() < b || pixel->y() < b || pixel->x() > camera().width - 1 - b || pixel->y() > camera().height - 1 - b)
      continue;
    seen.push_back({i, static_cast<int>(pixel->x() + 0.5) / config.cell_px,
                    static_cast<int>(pixel->y() + 0.5) / config.cell_px, static_cast<float>(p_C.norm()), true,
                    points.fresh[i] != 0});
  }
  const auto step = [&](float r) {
    return static_cast<float>(config.depth_step_m + config.depth_step_share * double(r));
  };
  const auto near = [&](const Seen& a, const Seen& b, double px) {
    const int reach = static_cast<int>(std::ceil(px / config.cell_px));
    return std::abs(a.column - b.column) <= reach && std::abs(a.row - b.row) <= reach;
  };
  const auto spacing_px = [&](float range_m) { return config.shadow_m * 302.5 / static_cast<double>(range_m); };
  std::vector<std::vector<float>> covering_m(64, std::vector<float>(80, std::numeric_limits<float>::infinity()));
  for (int row = 0; row < 64; ++row)
    for (int column = 0; column < 80; ++column)
      for (const Seen& b : seen) {
        float& least_m = covering_m[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
        if (near({.index = 0, .column = column, .row = row, .range_m = 0.0F}, b, spacing_px(b.range_m)))
          least_m = std::min(least_m, b.range_m);
      }
  const auto surrounded = [&](const Seen& a, float before_m) {
    const auto at = [&](int column, int row) {
      return covering_m[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    };
    if (at(a.column, a.row) >= before_m) return false;
    const int reach = static_cast<int>(std::ceil(spacing_px(at(a.column, a.row)) / config.cell_px));
    for (int row = std::max(0, a.row - reach); row <= std::min(63, a.row + reach); ++row)
      for (int column = std::max(0, a.column - reach); column <= std::min(79, a.column + reach); ++column)
        if (at(column, row) >= before_m) return false;
    return true;
  };
  for (Seen& a : seen) {
    const float before_m = a.range_m - step(a.range_m);
    for (const Seen& b : seen)
      if (near(a, b, 0) && b.range_m < before_m) a.in_sight = false;
    if (a.in_sight && !a.fresh && surrounded(a, before_m)) a.in_sight = false;
  }
  std::vector<std::size_t> kept;
  for (const Seen& a : seen) {
    bool clear = true;
    for (const Seen& b : seen) {
      const double shadow_px = config.shadow_px + config.shadow_m * 302.5 / static_cast<double>(b.range_m);
      if (near(a, b, shadow_px) && b.range_m < a.range_m - step(a.range_m)) clear = false;
      if (b.in_sight && near(a, b, config.edge_px) && b.range_m > a.range_m + step(a.range_m)) clear = false;
    }
    if (clear) kept.push_back(a.index);
  }
  return kept;
}

TEST(SampleImage, KeepsWhatComparingEveryPointWithEveryOtherKeeps) {
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const SE3 T_W_C(Vector3d(random.vector(0.3)), exp_so3(random.vector(0.15)));
    const SurfacePoints points = clutter(random, 1500);
    const SamplingConfig config{
        .shadow_px = 4 * (round % 4), .shadow_m = 0.01 * (round % 5), .edge_px = 4 * (round % 3)};
    const auto observations = sample_image(points, T_W_C, camera(), pattern_images(), config);
    const auto expected = naive(points, T_W_C, config);
    ASSERT_EQ(observations.size(), expected.size());
    EXPECT_GT(observations.size(), 20u);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_EQ(observations[i].p_W.cast<float>(), points.points_W[expected[i]]);
  }
}

TEST(SampleImage, DoesNotLookThroughANearSurfaceBetweenItsPoints) {
  // A cabinet's front half a metre away, a point every 5 cm, which is 30 pixels; a wall 2 m away.
  SurfacePoints points;
  for (int x = -5; x <= 5; ++x)
    for (int y = -5; y <= 5; ++y) {
      points.points_W.emplace_back(0.05F * static_cast<float>(x), 0.05F * static_cast<float>(y), 0.5F);
      points.points_W.emplace_back(0.05F * static_cast<float>(x) + 0.03F, 0.05F * static_cast<float>(y) + 0.03F, 2.0F);
    }
  for (const SurfaceObservation& seen : sample_image(points, SE3::Identity(), camera(), pattern_images(), {}))
    EXPECT_LT(seen.range_m, 1.0F);
}

TEST(SampleImage, DoesNotTakeAWallBehindASparselyMeasuredThingForItsSurroundings) {
  // A thing of 40 cm, 4 m away, that is measured every 10 cm, which is 8 pixels; a wall behind that was measured
  // before.
  SurfacePoints points;
  for (int x = -20; x <= 20; ++x)
    for (int y = -20; y <= 20; ++y)
      points.points_W.emplace_back(0.06F * static_cast<float>(x), 0.06F * static_cast<float>(y), 5.0F);
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      points.points_W.emplace_back(0.1F * static_cast<float>(x), 0.1F * static_cast<float>(y), 4.0F);
  const auto seen_of_thing = [&] {
    int inside = 0, rim = 0;
    for (const SurfaceObservation& seen : sample_image(points, SE3::Identity(), camera(), pattern_images(), {}))
      if (seen.p_W.z() < 4.5) ++(seen.p_W.head<2>().cwiseAbs().maxCoeff() < 0.15 ? inside : rim);
    return std::pair{inside, rim};
  };
  EXPECT_EQ(seen_of_thing(), std::pair(9, 0)) << "inside, and at the rim, where the image mixes it with the wall";
  points.fresh.assign(points.points_W.size(), 1);
  EXPECT_EQ(seen_of_thing(), std::pair(0, 0)) << "of a fence before a wall";
}

TEST(SampleImage, LeavesOutTheWallBesideAPanelThatHardlyStandsOut) {
  SurfacePoints points;
  for (float y = -1.0F; y <= 1.0F; y += 0.05F)
    for (float x = -1.5F; x <= 1.5F; x += 0.05F) {
      points.points_W.emplace_back(x, y, x < 0.0F ? 4.0F : 3.85F);
      points.normals_W.emplace_back(0.0F, 0.0F, -1.0F);
    }
  int walls = 0;
  for (const SurfaceObservation& seen : sample_image(points, SE3::Identity(), camera(), pattern_images(), {})) {
    EXPECT_FALSE(seen.p_W.x() > -0.1 && seen.p_W.x() < -1e-3) << "which is within 8 pixels of the panel";
    walls += seen.p_W.x() < 0.0 ? 1 : 0;
  }
  EXPECT_GT(walls, 500);
}

TEST(SampleImage, LeavesOutTheWallBesideABoxOnItThatIsSeenFromTheSide) {
  // The box stands out by 15 cm; along the line of sight the wall behind it lies farther by more than that, and the
  // wall at 60 degrees changes its range by as much within the box's shadow.
  SurfacePoints points;
  const float c = std::cos(1.05F), s = std::sin(1.05F);
  const Vector3f along_W(c, 0.0F, s), normal_W(s, 0.0F, -c);
  for (float y = -0.8F; y <= 0.8F; y += 0.05F)
    for (float x = -1.0F; x <= 1.0F; x += 0.05F) {
      const bool box = std::abs(y) < 0.3F && std::abs(x) < 0.3F;
      points.points_W.push_back(Vector3f(0.0F, y, 4.0F) + x * along_W + (box ? 0.15F : 0.0F) * normal_W);
      points.normals_W.push_back(normal_W);
    }
  for (const SurfaceObservation& seen : sample_image(points, SE3::Identity(), camera(), pattern_images(), {})) {
    const Vector3f q = seen.p_W.cast<float>() - Vector3f(0.0F, 0.0F, 4.0F);
    const bool wall = std::abs(q.dot(normal_W)) < 0.05F;
    const float behind_m = q.dot(along_W) - 0.3F;
    EXPECT_FALSE(wall && std::abs(q.y()) < 0.3F && behind_m > -0.02F && behind_m < 0.2F) << q.transpose();
  }
}

TEST(SampleImage, KeepsAWallThatIsSeenFromTheSide) {
  // At 55 degrees, from near to far: it does not hide itself.
  SurfacePoints wall;
  const float c = std::cos(0.96F), s = std::sin(0.96F);
  for (float y = -0.8F; y <= 0.8F; y += 0.05F)
    for (float along = -1.0F; along <= 1.0F; along += 0.05F) {
      wall.points_W.emplace_back(c * along, y, 4.0F + s * along);
      wall.normals_W.emplace_back(s, 0.0F, -c);
    }
  EXPECT_GT(sample_image(wall, SE3::Identity(), camera(), pattern_images(), {}).size(), wall.points_W.size() * 9 / 10);
}

TEST(SampleImage, ReadsThePixelThatTheLensShowsThePointIn) {
  Random random(2);
  SurfacePoints wall;
  for (int i = 0; i < 400; ++i)
    wall.points_W.emplace_back(static_cast<float>(random.uniform(-2.0, 2.0)),
                               static_cast<float>(random.uniform(-1.6, 1.6)), 4.0F);
  const SE3 T_W_C(Vector3d(0.1, -0.05, 0.0), exp_so3({0.02, -0.03, 0.3}));
  const auto observations = sample_image(wall, T_W_C, camera(), pattern_images(), {});
  ASSERT_GT(observations.size(), 300u);
  for (const SurfaceObservation& o : observations) {
    const Eigen::Vector2d pixel = *camera().project(T_W_C.inverse().act(o.p_W));
    EXPECT_NEAR(static_cast<double>(o.intensity), pattern(pixel.x(), pixel.y()), 1e-3);
    const int column = static_cast<int>(pixel.x() + 0.5), row = static_cast<int>(pixel.y() + 0.5);
    EXPECT_EQ(static_cast<int>(o.raw), (column + 3 * row) % 256);
    EXPECT_NEAR(static_cast<double>(o.range_m), (o.p_W - T_W_C.translation()).norm(), 1e-5);
    EXPECT_NEAR(static_cast<double>(o.footprint_m), static_cast<double>(o.range_m) / 302.5, 1e-6);
  }
}

TEST(SampleImage, TellsHowMuchDarkerAndBrighterTheImageIsCloseBy) {
  ImagePair images{cv::Mat(camera().height, camera().width, CV_32FC1, cv::Scalar(50.0)),
                   cv::Mat(camera().height, camera().width, CV_8UC1, cv::Scalar(50))};
  images.calibrated.colRange(160, 320).setTo(200.0);
  SurfacePoints wall;
  for (float x = -1.0F; x <= 1.0F; x += 0.01F) wall.points_W.emplace_back(x, 0.0F, 3.0F);
  int dark = 0, bright = 0;
  for (const SurfaceObservation& o : sample_image(wall, SE3::Identity(), camera(), images, {.aim_px = 4})) {
    const float off_px = o.pixel_px.x() - 159.5F;  // the edge
    if (std::abs(off_px) > 7.0F) {
      EXPECT_LT(o.dip + o.rise, 1.0F) << off_px;
    }
    if (std::abs(off_px) < 1.0F || std::abs(off_px) > 3.0F) continue;
    EXPECT_NEAR(off_px < 0.0F ? o.rise : o.dip, 150.0F, 1.0F) << off_px;
    ++(off_px < 0.0F ? dark : bright);
  }
  EXPECT_GT(dark, 0);
  EXPECT_GT(bright, 0);
}

TEST(SampleImage, LeavesOutWhatIsSeenAtAGrazingAngleOrTooFar) {
  SurfacePoints points;
  const auto add = [&](const Vector3f& p, const Vector3f& n) {
    points.points_W.push_back(p);
    points.normals_W.push_back(n.normalized());
  };
  add({0.0F, 0.0F, 3.0F}, {0.0F, 0.0F, -1.0F});
  add({0.5F, 0.0F, 3.0F}, {1.0F, 0.0F, -0.2F});  // grazing
  add({-0.5F, 0.0F, 3.0F}, Vector3f::Zero());
  add({0.0F, 0.5F, 11.0F}, {0.0F, 0.0F, -1.0F});  // beyond the gate
  points.normals_W[2].setZero();
  const auto observations = sample_image(points, SE3::Identity(), camera(), pattern_images(), {});
  ASSERT_EQ(observations.size(), 2u);
  EXPECT_NEAR(static_cast<double>(observations[0].cos_incidence), 1.0, 1e-6);
  EXPECT_EQ(observations[1].cos_incidence, 1.0F);
}

TEST(SampleImage, ReadsSixteenBits) {
  ImagePair images = pattern_images();
  images.raw = cv::Mat(camera().height, camera().width, CV_16UC1, cv::Scalar(54321));
  const SurfacePoints points{.points_W = {{0.0F, 0.0F, 3.0F}}, .normals_W = {}};
  EXPECT_EQ(sample_image(points, SE3::Identity(), camera(), images, {}).at(0).raw, 54321.0F);
}

TEST(SampleImage, LeavesOutWhatAHotThingWasSmearedOver) {
  // A wall, hot where x > 0; the camera turns so that the scene moves by 6 px to the right in a time constant, and the
  // image is what a bolometer makes of that.
  constexpr double kWay_px = 6.0, kCold = 100.0, kHot = 200.0;
  const Camera pinhole{.width = 320, .height = 256, .fx = 300.0, .fy = 300.0, .cx = 160.0, .cy = 128.0};
  const SE3 before = pose_from(exp_so3({0.0, kWay_px / pinhole.fx, 0.0}), Vector3d::Zero());
  ImagePair images{cv::Mat(pinhole.height, pinhole.width, CV_32FC1), cv::Mat(pinhole.height, pinhole.width, CV_8UC1)};
  images.raw.setTo(100);
  for (int row = 0; row < pinhole.height; ++row)
    for (int column = 0; column < pinhole.width; ++column) {
      const double x_px = column - pinhole.cx;  // where negative, it was hot until so many pixels of way ago
      images.calibrated.at<float>(row, column) =
          static_cast<float>(x_px < 0.0 ? kCold + (kHot - kCold) * std::exp(x_px / kWay_px) : kHot);
    }
  SurfacePoints wall;
  for (float y = -1.0F; y <= 1.0F; y += 0.02F)
    for (float x = -1.5F; x <= 1.5F; x += 0.02F) {
      wall.points_W.emplace_back(x, y, 4.0F);
      wall.normals_W.emplace_back(0.0F, 0.0F, -1.0F);
    }
  const auto all = sample_image(wall, SE3::Identity(), pinhole, images, {});
  const auto sharp = sample_image(wall, SE3::Identity(), pinhole, images, {}, Smear{before, 10.0F});
  EXPECT_GT(sharp.size(), all.size() * 3 / 4);
  double worst_of_all = 0.0, worst = 0.0;
  const auto error = [&](const SurfaceObservation& o) {
    return std::abs(o.intensity - (o.pixel_px.x() < pinhole.cx ? kCold : kHot));
  };
  for (const SurfaceObservation& o : all) worst_of_all = std::max(worst_of_all, error(o));
  for (const SurfaceObservation& o : sharp) worst = std::max(worst, error(o));
  EXPECT_GT(worst_of_all, 60.0);
  EXPECT_LT(worst, 15.0);
}

}  // namespace
}  // namespace pllit
