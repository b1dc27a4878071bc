#include "pllit/sim/camera/thermal_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

#include "pllit/sim/camera/camera_presets.hpp"
#include "pllit/sim/camera/pixel_truth.hpp"
#include "sim/camera/faultless_camera.hpp"
#include "sim/camera/test_place.hpp"

namespace pllit {
namespace {

const CameraPath kAtRest = [](Time) { return looking_along_y(); };

ThermalCameraModel ideal_camera() {
  ThermalCameraModel model = faultless_camera(200.0);
  model.samples = 16;
  return model;
}

ThermalFrame capture(const ThermalCameraModel& model, const Place& place, const CameraPath& path = kAtRest,
                     int threads = 2) {
  Arena arena(threads);
  RayCaster caster(place, 60.0);
  caster.move_to(Vector3d::Zero(), 1.0);
  ThermalCamera camera(model, place, Time{}, 7);
  return camera.capture(caster, path, Time(from_seconds(1.0)), arena);
}

/// Where a row crosses from its left to its right level: the place of a sharp edge that would leave the same sum.
double edge_px(const cv::Mat& counts, int row, int from, int to) {
  const auto* value = counts.ptr<std::uint16_t>(row);
  const double left = value[from], right = value[to];
  double sum = 0.0;
  for (int column = from; column <= to; ++column) sum += (value[column] - right) / (left - right);
  return from - 0.5 + sum;
}

TEST(ThermalCamera, ASharpEdgeLiesWhereTheCameraModelProjectsIt) {
  ThermalCameraModel model = ideal_camera();
  model.camera.k = {-0.2, 0.05, 0.001, -0.001, 0.0};
  Camera fisheye = model.camera;
  fisheye.distortion = Camera::Distortion::equidistant;
  fisheye.k = {-0.037, -0.009, 0.009, -0.004, 0.0};
  for (const Camera& camera : {model.camera, fisheye}) {
    model.camera = camera;
    for (const double x_m : {-1.013, 0.0, 0.4571}) {
      const cv::Mat counts = capture(model, two_walls(x_m, plain_surface(0.0F), plain_surface(10.0F))).counts;
      for (const double z_m : {0.8, 0.0, -0.9}) {
        // The row that shows the height, and the point of the edge that this row's centre sees.
        const auto pixel = camera.project({x_m, -z_m, 4.0});
        const int row = static_cast<int>(std::lround(pixel->y()));
        const double slope = (camera.project({x_m, -z_m + 0.01, 4.0})->x() - pixel->x()) /
                             (camera.project({x_m, -z_m + 0.01, 4.0})->y() - pixel->y());
        const double expected_px = pixel->x() + slope * (row - pixel->y());
        const int middle = static_cast<int>(std::lround(expected_px));
        EXPECT_NEAR(edge_px(counts, row, middle - 6, middle + 6), expected_px, 0.1) << "x " << x_m << " z " << z_m;
      }
    }
  }
}

TEST(ThermalCamera, CountsPerKelvinAreAsAsked) {
  const TestPlace place = two_walls(0.0, plain_surface(5.85F), plain_surface(7.85F));
  const cv::Mat counts = capture(ideal_camera(), place).counts;
  // 299 and 301 K, seen at right angles.
  EXPECT_NEAR(counts.at<std::uint16_t>(60, 100) - counts.at<std::uint16_t>(60, 60), 400, 4);
  EXPECT_NEAR(counts.at<std::uint16_t>(60, 60), 7000 - 200, 4);
}

TEST(ThermalCamera, NoiseOnAnEvenWallIsTheNetd) {
  ThermalCameraModel model = ideal_camera();
  model.netd_K = 0.05;
  const cv::Mat counts = capture(model, two_walls(10.0, plain_surface(6.85F), plain_surface(6.85F))).counts;
  cv::Scalar mean, sigma;
  cv::meanStdDev(counts, mean, sigma);
  EXPECT_NEAR(sigma[0], 0.05 * 200.0, 0.2);
}

TEST(ThermalCamera, OpticsBlurAnEdgeByTheirWidth) {
  ThermalCameraModel model = ideal_camera();
  model.blur_sigma_px = 1.2;
  const cv::Mat counts = capture(model, two_walls(0.013, plain_surface(0.0F), plain_surface(20.0F))).counts;
  double sum = 0.0, squares = 0.0, weight = 0.0;  // of the edge's derivative, averaged over rows
  for (int row = 20; row < 100; ++row)
    for (int column = 65; column < 95; ++column) {
      const double step = counts.at<std::uint16_t>(row, column + 1) - counts.at<std::uint16_t>(row, column);
      weight += step;
      sum += step * column;
      squares += step * column * column;
    }
  const double variance = squares / weight - std::pow(sum / weight, 2);
  // The pixel's own width adds 1/12, the difference of neighbours as much again.
  EXPECT_NEAR(std::sqrt(variance - 1.0 / 6.0), 1.2, 0.08);
}

TEST(ThermalCamera, AFastTurnSmearsAnEdgeByRateTimesTimeConstant) {
  ThermalCameraModel model = ideal_camera();
  model.time_constant_s = 0.010;
  constexpr double speed_mps = 4.0;  // sideways, 4 m from the wall: 193 px/s
  const CameraPath path = [](Time time) { return looking_along_y({speed_mps * (to_seconds(time) - 1.0), 0.0, 0.0}); };
  const cv::Mat counts = capture(model, two_walls(0.0, plain_surface(0.0F), plain_surface(20.0F)), path).counts;
  double sum = 0.0, squares = 0.0, weight = 0.0;
  for (int row = 10; row < 110; ++row)
    for (int column = 60; column < 110; ++column) {
      const double step = counts.at<std::uint16_t>(row, column + 1) - counts.at<std::uint16_t>(row, column);
      weight += step;
      sum += step * (column + 0.5);
      squares += step * (column + 0.5) * (column + 0.5);
    }
  const double mean_px = sum / weight, sigma_px = std::sqrt(squares / weight - mean_px * mean_px - 1.0 / 6.0);
  EXPECT_NEAR(mean_px, 79.5 + 1.93, 0.1) << "the edge lags by one time constant";
  EXPECT_NEAR(sigma_px, 1.93, 0.2) << "an exponential's deviation is its time constant";
}

TEST(ThermalCamera, TheShutterFreezesTheVideoWithAdvancingStampsAndThenItJumps) {
  ThermalCameraModel model = ideal_camera();
  model.camera = {.width = 64, .height = 48, .fx = 80.0, .fy = 80.0, .cx = 31.5, .cy = 23.5};
  model.netd_K = 0.05;
  model.fixed_pattern = {};
  model.fixed_pattern.whole_left = 0.5;
  model.shutter = {.least_interval_s = 2.0, .most_interval_s = 3.0, .least_freeze_s = 0.3, .most_freeze_s = 0.5};
  const TestPlace place = two_walls(0.0, plain_surface(0.0F), plain_surface(10.0F));
  Arena arena(2);
  RayCaster caster(place, 60.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  ThermalCamera camera(model, place, Time{}, 3);
  std::optional<ThermalFrame> before;
  int frozen = 0, events = 0;
  for (int i = 0; i < 200; ++i) {
    const Time time(from_seconds(0.05 * i));
    const ThermalFrame frame = camera.capture(caster, kAtRest, time, arena);
    EXPECT_EQ(frame.time, time);
    if (before) {
      const bool same = cv::norm(frame.counts, before->counts, cv::NORM_INF) == 0.0 &&
                        cv::norm(frame.grey, before->grey, cv::NORM_INF) == 0.0;
      EXPECT_EQ(same, frame.frozen);
      const double jump = std::abs(cv::mean(frame.counts)[0] - cv::mean(before->counts)[0]);
      if (before->frozen && !frame.frozen) {
        ++events;
        EXPECT_GT(jump, 3.0);
      } else {
        EXPECT_LT(jump, 6.0);
      }
    }
    frozen += frame.frozen ? 1 : 0;
    before = frame;
  }
  EXPECT_GE(events, 3);
  EXPECT_NEAR(frozen / static_cast<double>(events), 8.0, 3.0) << "frames a freeze at 20 Hz";
}

TEST(ThermalCamera, TheSameSeedGivesTheSameBytesForAnyThreads) {
  ThermalCameraModel model;
  model.camera = small_camera();
  const TestPlace place = room();
  const ThermalFrame one = capture(model, place, kAtRest, 1), two = capture(model, place, kAtRest, 2);
  EXPECT_EQ(cv::norm(one.counts, two.counts, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(one.grey, two.grey, cv::NORM_INF), 0.0);
}

TEST(ThermalCamera, AHotKettleTakesGreysFromEverythingElse) {
  ThermalCameraModel model = ideal_camera();
  model.counts_per_K = 30.0;
  model.agc = {.kind = AgcConfig::Kind::linear, .tail = 0.001, .max_gain = 10.0, .speed_256 = 256};
  const TestPlace place = room();
  Arena arena(2);
  RayCaster caster(place, 60.0);
  ThermalCamera camera(model, place, Time{}, 7);
  caster.move_to(Vector3d::Zero(), 5.0);
  const cv::Mat cold = camera.capture(caster, kAtRest, Time(from_seconds(5.0)), arena).grey;
  caster.move_to(Vector3d::Zero(), 400.0);
  const cv::Mat hot = camera.capture(caster, kAtRest, Time(from_seconds(400.0)), arena).grey;
  EXPECT_LT(cv::mean(hot.colRange(0, 60))[0], cv::mean(cold.colRange(0, 60))[0] - 20.0);
}

TEST(PixelTruth, DepthAndTemperatureOfAWallAreThoseOfThePlace) {
  const TestPlace place = two_walls(0.0, plain_surface(0.0F), plain_surface(10.0F));
  Arena arena(2);
  RayCaster caster(place, 60.0);
  caster.move_to(Vector3d::Zero(), 0.0);
  const ThermalBand band;
  const RayTable table(small_camera());
  const PixelTruth truth =
      pixel_truth(table, caster, Heat(place, band, 0.0, table.pixel_rad()), looking_along_y(), arena);
  EXPECT_NEAR(truth.depth_m.at<float>(5, 10), 4.0F, 1e-4F);
  EXPECT_NEAR(truth.range_m.at<float>(5, 10), 4.0 / small_camera().ray({10.0, 5.0}).z(), 1e-4);
  EXPECT_NEAR(truth.temperature_K.at<float>(60, 30), place.climate_.air_K, 1e-3);
  EXPECT_NEAR(truth.temperature_K.at<float>(60, 130), place.climate_.air_K + 10.0, 1e-3);
}

TEST(CameraPresets, SpanTheAnglesTheyAreSoldWith) {
  const auto across_deg = [](const Camera& camera) {
    const Vector3d left = camera.ray({-0.5, camera.cy}), right = camera.ray({camera.width - 0.5, camera.cy});
    return std::acos(left.dot(right)) * 180.0 / 3.14159265358979;
  };
  EXPECT_NEAR(across_deg(botu_tb640().camera), 48.0, 3.0);
  EXPECT_NEAR(across_deg(boson_640().camera), 50.0, 1.0);
  EXPECT_GT(across_deg(hilti2022_cam0().camera), 100.0);
}

}  // namespace
}  // namespace pllit
