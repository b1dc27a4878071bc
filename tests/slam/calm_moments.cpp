#include "pllit/slam/calm_moments.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/image_world.hpp"

namespace pllit {
namespace {

Time at(double seconds) { return Time{from_seconds(seconds)}; }

Rig rig() {
  Rig rig;
  rig.camera = test::thermal_camera();
  rig.T_I_C = test::camera_ahead();
  rig.lidar.min_range_m = 0.5;
  return rig;
}

/// A rig that turns about z, at rates that differ from second to second; images at 10 Hz, scans of one landmark.
template <class RateAt>
std::vector<CalmMoment> moments_of(double duration_s, const RateAt& rate_rps, const Vector3d& landmark_W) {
  CalmMoments moments(rig());
  double angle = 0.0;
  LidarScan scan;
  for (int step = 0; step < static_cast<int>(200.0 * duration_s); ++step) {
    const double t = 0.005 * step;
    angle += 0.005 * rate_rps(t);
    moments.add({.received = at(t), .data = ImuSample{.time = at(t), .gyro_rps = {0.0, 0.0, rate_rps(t)}}});
    if (step % 20 == 0) {
      if (!scan.points_L.empty()) moments.add({.received = at(t), .data = scan});
      scan = LidarScan{.start = at(t), .points_L = {}, .offsets = {}, .intensity = {}};
    }
    const Vector3d p_I = exp_so3(Vector3d(0.0, 0.0, -angle)).act(landmark_W);
    scan.points_L.push_back(p_I.cast<float>());
    scan.offsets.push_back(at(t) - scan.start);
    scan.intensity.push_back(0.0F);
    if (step % 20 == 10)
      moments.add({.received = at(t), .data = CameraFrame{.time = at(t), .counts = cv::Mat(2, 2, CV_8UC1)}});
  }
  return moments.moments();
}

TEST(CalmMoments, AreTheCalmestOfSpansThatCoverTheRecording) {
  const auto moments = moments_of(60.0, [](double t) { return 0.2 + 0.1 * std::sin(t); }, {5.0, 0.0, 0.0});
  ASSERT_GE(moments.size(), 3);
  ASSERT_LE(moments.size(), 6);
  for (std::size_t i = 0; i < moments.size(); ++i) {
    EXPECT_LT(moments[i].turn_rps, 0.11) << "a sine's trough lies in each span";
    if (i == 0) continue;
    EXPECT_GT(moments[i].time, moments[i - 1].time);
  }
  EXPECT_GT(to_seconds(moments.back().time - moments.front().time), 25.0);
}

TEST(CalmMoments, HaveTheirPointsAsFromTheImagesTime) {
  const auto moments = moments_of(1.0, [](double) { return 0.6; }, {5.0, 0.0, 0.0});
  ASSERT_EQ(moments.size(), 1);
  ASSERT_EQ(moments[0].points_C.size(), 20);
  for (const Vector3f& p_C : moments[0].points_C) EXPECT_LT((p_C - moments[0].points_C[0]).norm(), 0.02);
}

TEST(CalmMoments, AreNoneWithoutScansOrWithoutAnImu) {
  CalmMoments no_scans(rig()), no_imu(rig());
  no_scans.add({.received = at(0.0), .data = ImuSample{.time = at(0.0)}});
  for (CalmMoments* moments : {&no_scans, &no_imu})
    for (int i = 0; i < 100; ++i)
      moments->add(
          {.received = at(0.1 * i), .data = CameraFrame{.time = at(0.1 * i), .counts = cv::Mat(2, 2, CV_8UC1)}});
  no_imu.add({.received = at(10.0),
              .data = LidarScan{
                  .start = at(0.0), .points_L = {{1.0F, 0.0F, 0.0F}}, .offsets = {Duration{0}}, .intensity = {0.0F}}});
  EXPECT_TRUE(no_scans.moments().empty());
  EXPECT_TRUE(no_imu.moments().empty());
}

}  // namespace
}  // namespace pllit
