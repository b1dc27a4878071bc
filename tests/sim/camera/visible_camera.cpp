#include "pllit/sim/camera/visible_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "sim/camera/test_place.hpp"

namespace pllit {
namespace {

const CameraPath kAtRest = [](Time) { return looking_along_y(); };

VisibleCameraModel small_model() {
  VisibleCameraModel model;
  model.camera = small_camera();
  return model;
}

/// Ten images a second from a caster that stays where it is.
std::vector<VisibleFrame> video(const VisibleCameraModel& model, const Place& place, int frames,
                                const CameraPath& path = kAtRest, int threads = 2) {
  Arena arena(threads);
  RayCaster caster(place, 60.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  VisibleCamera camera(model, place, Time{}, 7);
  std::vector<VisibleFrame> images;
  for (int i = 0; i < frames; ++i) images.push_back(camera.capture(caster, path, Time(from_seconds(0.1 * i)), arena));
  return images;
}

TestPlace grey_walls(double ambient_light) {
  TestPlace place = two_walls(0.0, plain_surface(0.0F, 0.3F), plain_surface(0.0F, 0.6F));
  place.climate_.ambient_light = ambient_light;
  return place;
}

double mean_signal(const VisibleFrame& frame, double gamma) {
  double sum = 0.0;
  for (int row = 0; row < frame.grey.rows; ++row)
    for (int column = 0; column < frame.grey.cols; ++column)
      sum += std::pow(frame.grey.at<std::uint8_t>(row, column) / 255.0, gamma);
  return sum / static_cast<double>(frame.grey.total());
}

TEST(VisibleCamera, ExposureConvergesToItsTargetInBrightAndDimPlaces) {
  const VisibleCameraModel model = small_model();
  for (const double light : {1.0, 0.1, 0.05}) {
    const auto images = video(model, grey_walls(light), 25);
    EXPECT_NEAR(mean_signal(images.back(), model.gamma), model.exposure.target, 0.02) << light;
    EXPECT_NEAR(images.back().exposure_s * images.back().gain, images[22].exposure_s * images[22].gain,
                0.02 * images.back().exposure_s * images.back().gain);
  }
}

TEST(VisibleCamera, ExposureReactsLateSoThatALampSwitchedOnIsOverexposedAtFirst) {
  VisibleCameraModel model = small_model();
  model.exposure.delay_frames = 3;
  const auto images = video(model, grey_walls(0.03), 10);
  EXPECT_EQ(images[0].exposure_s, images[2].exposure_s);
  EXPECT_NE(images[2].exposure_s, images[3].exposure_s);
}

TEST(VisibleCamera, NightIsDarkAndNoisyInSpiteOfTheGain) {
  VisibleCameraModel model = small_model();
  model.vignetting = 0.0;
  const VisibleFrame day = video(model, grey_walls(0.6), 20).back(),
                     night = video(model, grey_walls(0.0005), 20).back();
  const cv::Rect on_one_wall(5, 50, 60, 20);
  cv::Scalar day_mean, day_sigma, night_mean, night_sigma;
  cv::meanStdDev(day.grey(on_one_wall), day_mean, day_sigma);
  cv::meanStdDev(night.grey(on_one_wall), night_mean, night_sigma);
  EXPECT_EQ(night.exposure_s, model.exposure.most_s);
  EXPECT_NEAR(night.gain, model.exposure.most_gain, 1e-9);
  EXPECT_LT(night_mean[0], 0.5 * day_mean[0]);
  EXPECT_GT(night_sigma[0], 3.0 * day_sigma[0]);
}

TEST(VisibleCamera, MotionSmearsAnEdgeOverSpeedTimesExposure) {
  VisibleCameraModel model = small_model();
  model.blur_sigma_px = 0.0;
  model.vignetting = 0.0;
  model.gamma = 1.0;
  model.full_well_e = 1e9;
  model.exposure.least_s = model.exposure.most_s = 0.02;
  model.exposure.most_gain = 1.0;
  model.full_light_s = 0.02;
  const CameraPath path = [](Time time) { return looking_along_y({8.0 * to_seconds(time), 0.0, 0.0}); };  // 386 px/s
  model.exposure.delay_frames = 1;
  model.exposure.target = 1.0;  // starts at, and stays at, the only exposure there is
  const cv::Mat grey = video(model, grey_walls(0.9), 1, path).front().grey;
  double sum = 0.0, squares = 0.0, weight = 0.0;
  for (int row = 10; row < 110; ++row)
    for (int column = 60; column < 100; ++column) {
      const double step = grey.at<std::uint8_t>(row, column + 1) - grey.at<std::uint8_t>(row, column);
      weight += step;
      sum += step * (column + 0.5);
      squares += step * (column + 0.5) * (column + 0.5);
    }
  const double mean_px = sum / weight, variance = squares / weight - mean_px * mean_px - 1.0 / 6.0;
  EXPECT_NEAR(mean_px, 79.5, 0.15) << "the middle of the exposure is the image's time";
  EXPECT_NEAR(std::sqrt(12.0 * variance), 8.0 * 0.02 * 193.0 / 4.0, 0.5) << "a box of this length";
}

TEST(VisibleCamera, SunAndShadowDifferAndLampsGlow) {
  VisibleCameraModel model = small_model();
  TestPlace place = grey_walls(0.3);
  place.surfaces_[1] = place.surfaces_[0];
  place.climate_.sun = 0.7;
  place.climate_.to_sun_W = Vector3d(0.0, -1.0, 0.2).normalized();
  Surface lamp = plain_surface(0.0F);
  lamp.glow = 3.0F;
  place.surfaces_.push_back(lamp);
  add_box(place.mesh_, {0.5F, 3.8F, -0.2F}, {0.9F, 3.9F, 0.2F}, 2);
  add_box(place.mesh_, {-3.0F, -3.0F, -2.0F}, {-0.4F, -2.5F, 4.0F}, 0);  // behind the camera, before the sun
  const cv::Mat grey = video(model, place, 20).back().grey;
  const auto at = [&](int row, int column) { return static_cast<int>(grey.at<std::uint8_t>(row, column)); };
  EXPECT_LT(at(60, 40), 0.8 * at(60, 85));
  EXPECT_GT(at(59, 113), at(59, 85) + 40);
}

TEST(VisibleCamera, TheSameSeedGivesTheSameBytesForAnyThreads) {
  const TestPlace place = room();
  const auto one = video(small_model(), place, 2, kAtRest, 1), two = video(small_model(), place, 2, kAtRest, 2);
  EXPECT_EQ(cv::norm(one[1].grey, two[1].grey, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace pllit
