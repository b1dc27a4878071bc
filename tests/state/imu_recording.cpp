// Dead reckoning on a real IMU, between poses that a LiDAR odometry measured.
#include <gtest/gtest.h>

#include <algorithm>

#include "pllit/state/iterated_update.hpp"
#include "pllit/state/propagation.hpp"
#include "pllit/state/start_up.hpp"
#include "support/imu_recording.hpp"
#include "support/recordings.hpp"

namespace pllit {
namespace {

namespace ix = error_index;
using namespace std::chrono_literals;

/// The reference pose as a sensor of the given standard deviations.
Linearize pose_sensor(const SE3& measured, double sigma_rad, double sigma_m) {
  return [=](const NavState& x) {
    NormalEquations sums;
    const Vector3d theta = log_so3(measured.asSO3().inverse() * x.R_W_I);
    const Matrix3d J = right_jacobian_inverse(theta);
    sums.H.block<3, 3>(ix::theta, ix::theta) = J.transpose() * J / (sigma_rad * sigma_rad);
    sums.b.segment<3>(ix::theta) = -J.transpose() * theta / (sigma_rad * sigma_rad);
    sums.H.block<3, 3>(ix::p, ix::p) = Matrix3d::Identity() / (sigma_m * sigma_m);
    sums.b.segment<3>(ix::p) = (measured.translation() - x.p_W) / (sigma_m * sigma_m);
    sums.inliers = 6;
    return sums;
  };
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + values.size() / 2);
  return values[values.size() / 2];
}

TEST(DeadReckoning, KeepsToTheReferenceForASecondOnARealImu) {
  PLLIT_RECORDING(imu_path, "imu_continuous/imu.txt");
  PLLIT_RECORDING(truth_path, "imu_continuous/traj.txt");
  const auto imu = test::read_imu_text(imu_path);
  const auto truth = test::read_trajectory_text(truth_path);
  const ImuNoise noise{.gyro_density = 0.002, .accel_density = 0.02};

  // A filter with the reference as its pose sensor learns velocity, biases and gravity; from each of its states, dead
  // reckoning for one second with the IMU alone.
  const auto start = start_up(std::span(imu).first(110), noise, {});
  ASSERT_TRUE(start && *start);
  Estimate estimate = (*start)->estimate;
  const auto first = std::ranges::find_if(truth, [&](const StampedPose& p) { return p.time >= estimate.mean.time; });
  const SO3 R_truth_start = first->T_W_I.asSO3();
  // The reference's world may be tilted: take its attitude, and turn gravity into it.
  estimate.mean.gravity_W = (R_truth_start * estimate.mean.R_W_I.inverse()).act(estimate.mean.gravity_W);
  estimate.mean.R_W_I = R_truth_start;
  estimate.mean.p_W = first->T_W_I.translation();
  estimate.mean.time = first->time;
  estimate.covariance.diagonal().head<6>().setConstant(1e-2);

  std::vector<double> position_m, angle_deg;
  for (auto pose = first + 1; pose + 10 < truth.end() && (pose + 10)->time < imu.back().time; ++pose) {
    estimate = propagate(estimate, imu, pose->time, noise).predicted;
    estimate = iterated_update(estimate, pose_sensor(pose->T_W_I, 0.002, 0.005), {}).posterior;
    if (pose->time - first->time < 20s) continue;  // biases are still being learnt
    const StampedPose& later = *(pose + 10);
    if (later.time - pose->time > 1100ms) continue;  // the reference has a gap
    const NavState reckoned = propagate(estimate, imu, later.time, noise).predicted.mean;
    // Relative to the filter's own state: the error of dead reckoning, not of the start.
    const SE3 relative = estimate.mean.T_W_I().inverse() * reckoned.T_W_I();
    const SE3 error = (pose->T_W_I.inverse() * later.T_W_I).inverse() * relative;
    position_m.push_back(error.translation().norm());
    angle_deg.push_back(log_so3(error.asSO3()).norm() * 180.0 / M_PI);
  }
  ASSERT_GT(position_m.size(), 1500u);
  RecordProperty("median_position_m", std::to_string(median(position_m)));
  RecordProperty("median_angle_deg", std::to_string(median(angle_deg)));
  EXPECT_LE(median(position_m), 0.025);
  EXPECT_LE(median(angle_deg), 0.1);
}

}  // namespace
}  // namespace pllit
