#include "pllit/lidar/deskew.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <fstream>

#include "support/random_states.hpp"
#include "support/recordings.hpp"

namespace pllit {
namespace {

using namespace std::chrono_literals;
using test::Random;

constexpr LidarModel any_range{.min_range_m = 0.0, .max_range_m = 1e3};

LidarScan random_scan(Random& random, int points, double length_s) {
  LidarScan scan;
  scan.start = Time(1s);
  for (int i = 0; i < points; ++i) {
    scan.points_L.push_back(random.vector(20.0).cast<float>());
    scan.offsets.push_back(from_seconds(length_s * i / (points - 1)));
    scan.intensity.push_back(static_cast<float>(i));
  }
  return scan;
}

Propagation random_motion(Random& random, double imu_rate_hz, Time begin, Time end, double agility = 1.0) {
  Estimate start;
  start.mean = random.state();
  start.mean.time = begin;
  std::vector<ImuSample> imu;
  for (Time t = begin - 5ms; t < end + from_seconds(1.0 / imu_rate_hz); t += from_seconds(1.0 / imu_rate_hz))
    imu.push_back({t, random.vector(agility), random.vector(agility) + Vector3d(0.0, 0.0, 9.81)});
  return propagate(start, imu, end, ImuNoise{});
}

/// The obvious twin: every point moved by the exact pose at its own time.
std::vector<Vector3d> by_brute_force(const LidarScan& scan, const MotionPath& path, const SE3& T_I_L) {
  const SE3 T_W_end = path.pose_at(path.nodes.back().time);
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < scan.points_L.size(); ++i)
    points.push_back(
        (T_W_end.inverse() * path.pose_at(scan.start + scan.offsets[i]) * T_I_L).act(scan.points_L[i].cast<double>()));
  return points;
}

TEST(Deskew, EqualsItsBruteForceTwinAtAnyImuRate) {
  Random random(21);
  for (const double rate_hz : {10.0, 100.0, 200.0, 1000.0}) {
    const LidarScan scan = random_scan(random, 3000, 0.1);
    const SE3 T_I_L = pose_from(random.rotation(), random.vector(0.3));
    const auto path = random_motion(random, rate_hz, scan.start - 2ms, scan.end(), 2.0).path;
    const PointCloud cloud = deskew(scan, path, T_I_L, any_range);
    const auto twin = by_brute_force(scan, path, T_I_L);
    ASSERT_EQ(cloud.points_I.size(), twin.size());
    double worst_m = 0.0;
    for (std::size_t i = 0; i < twin.size(); ++i)
      worst_m = std::max(worst_m, (cloud.points_I[i].cast<double>() - twin[i]).norm());
    EXPECT_LT(worst_m, 2e-5) << rate_hz << " Hz";  // float points tens of metres away resolve 4e-6 m
  }
}

TEST(Deskew, ContinuesTheFirstMotionForPointsBeforeThePath) {
  Random random(22);
  const LidarScan scan = random_scan(random, 500, 0.1);
  const auto path = random_motion(random, 100.0, scan.start + 20ms, scan.end()).path;
  const PointCloud cloud = deskew(scan, path, SE3::Identity(), any_range);
  const auto twin = by_brute_force(scan, path, SE3::Identity());
  for (std::size_t i = 0; i < twin.size(); ++i) EXPECT_LT((cloud.points_I[i].cast<double>() - twin[i]).norm(), 2e-5);
}

TEST(Deskew, LeavesAScanOfARigAtRestAlone) {
  Random random(23);
  const LidarScan scan = random_scan(random, 500, 0.1);
  Estimate start;
  start.mean.time = scan.start;
  std::vector<ImuSample> imu;
  for (int i = 0; i <= 20; ++i) imu.push_back({scan.start + i * 5ms, Vector3d::Zero(), Vector3d(0.0, 0.0, 9.81)});
  const SE3 T_I_L = pose_from(random.rotation(), random.vector(0.3));
  const PointCloud cloud = deskew(scan, propagate(start, imu, scan.end(), ImuNoise{}).path, T_I_L, any_range);
  for (std::size_t i = 0; i < scan.points_L.size(); ++i)
    EXPECT_LT((cloud.points_I[i].cast<double>() - T_I_L.act(scan.points_L[i].cast<double>())).norm(), 1e-5);
}

TEST(Deskew, KeepsOnlyPointsWithinTheRange) {
  LidarScan scan;
  scan.points_L = {{0.3F, 0.0F, 0.0F}, {5.0F, 0.0F, 0.0F}, {200.0F, 0.0F, 0.0F}};
  scan.offsets = {0ms, 1ms, 2ms};
  scan.intensity = {1.0F, 2.0F, 3.0F};
  const MotionPath path{
      {PathNode{Time{}, SO3::Identity(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()}}};
  EXPECT_THAT(deskew(scan, path, SE3::Identity(), {.min_range_m = 0.5, .max_range_m = 100.0}).intensity,
              testing::ElementsAre(2.0F));
}

template <class T>
std::vector<T> read_binary(const std::filesystem::path& path) {
  std::vector<T> values(std::filesystem::file_size(path) / sizeof(T));
  std::ifstream(path, std::ios::binary)
      .read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
  return values;
}

/// Pose that takes raw points to deskewed ones, from those measured within 60 microseconds of `time`, which are one or
/// two columns, or in a wider span where there are gaps.
SE3 pose_from_points(const LidarScan& scan, const std::vector<Vector3d>& expected, const SE3& T_I_L, Duration time) {
  std::vector<std::size_t> near;
  for (std::int64_t span_ns = 60'000; near.size() < 10; span_ns *= 2) {
    near.clear();
    for (std::size_t i = 0; i < expected.size(); ++i)
      if (std::abs((scan.offsets[i] - time).count()) < span_ns) near.push_back(i);
  }
  Eigen::Matrix3Xd from(3, near.size()), to(3, near.size());
  for (std::size_t k = 0; k < near.size(); ++k) {
    from.col(static_cast<Eigen::Index>(k)) = T_I_L.act(scan.points_L[near[k]].cast<double>());
    to.col(static_cast<Eigen::Index>(k)) = expected[near[k]];
  }
  const Eigen::Matrix4d T = Eigen::umeyama(from, to, false);
  return pose_from(rotation_from(Eigen::Quaterniond(Matrix3d(T.topLeftCorner<3, 3>()))), T.topRightCorner<3, 1>());
}

TEST(Deskew, ReproducesAnotherProgramsResultOnRealScans) {
  // gtsam_points deskewed these scans of the Newer College recording, into the IMU frame at the first point's time.
  // With which motion is not recorded: poses every 5 ms are read off its result, and between them ours must agree. The
  // extrinsics are read off the points at time zero, which only they move.
  const SE3 T_I_L = pose_from(exp_so3({0.0, 0.0, M_PI}), {-0.006, 0.012, -0.029});
  for (const std::string name : {"00", "01", "02"}) {
    PLLIT_RECORDING(raw_path, "deskew_newer_college/raw_" + name + ".bin");
    const auto raw = read_binary<Eigen::Vector3f>(raw_path);
    const auto times = read_binary<float>(raw_path.parent_path() / ("times_" + name + ".bin"));
    const auto deskewed = read_binary<Eigen::Vector3f>(raw_path.parent_path() / ("deskewed_" + name + ".bin"));
    ASSERT_EQ(raw.size(), deskewed.size());
    ASSERT_TRUE(std::ranges::is_sorted(times));
    LidarScan scan;
    std::vector<Vector3d> expected;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      scan.points_L.push_back(raw[i]);
      scan.offsets.push_back(from_seconds(times[i]));
      scan.intensity.push_back(0.0F);
      expected.push_back(deskewed[i].cast<double>());
    }
    MotionPath path;
    for (int k = 0; k <= 20; ++k) {
      const Duration time = k * (scan.end() - scan.start) / 20;
      const SE3 pose = pose_from_points(scan, expected, T_I_L, time);
      path.nodes.push_back({scan.start + time, rotation_from(pose.quat()), pose.translation(), Vector3d::Zero(),
                            Vector3d::Zero(), Vector3d::Zero()});
    }
    for (int k = 0; k < 20; ++k) {
      const double dt = to_seconds(path.nodes[k + 1].time - path.nodes[k].time);
      path.nodes[k].v_W = (path.nodes[k + 1].p_W - path.nodes[k].p_W) / dt;
      path.nodes[k].omega_I = log_so3(path.nodes[k].R_W_I.inverse() * path.nodes[k + 1].R_W_I) / dt;
    }
    const PointCloud cloud = deskew(scan, path, T_I_L, {.min_range_m = 0.0, .max_range_m = 1e4});
    ASSERT_EQ(cloud.points_I.size(), raw.size());
    const SE3 T_start_end = pose_from(path.nodes.back().R_W_I, path.nodes.back().p_W);
    std::vector<double> errors_m;
    double moved_m = 0.0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      errors_m.push_back((T_start_end.act(cloud.points_I[i].cast<double>()) - expected[i]).norm());
      moved_m = std::max(moved_m, (T_I_L.act(raw[i].cast<double>()) - expected[i]).norm());
    }
    std::ranges::sort(errors_m);
    EXPECT_GT(moved_m, 0.1) << name << " shows no motion to take out";
    EXPECT_LT(errors_m[errors_m.size() / 2], 0.003) << name;
    EXPECT_LT(errors_m[errors_m.size() * 99 / 100], 0.015 * moved_m) << name;
  }
}

}  // namespace
}  // namespace pllit
