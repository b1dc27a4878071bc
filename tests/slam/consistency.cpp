// Does the filter know how wrong it is? Normalised errors over many seeded runs.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/random_states.hpp"
#include "support/simulated_run.hpp"

namespace pllit {
namespace {

namespace ix = error_index;

/// A map of a world as it is: dense points on every surface, without noise.
PlaneMap known_map(const PlanesWorld& world, const PlaneMapConfig& config) {
  PlaneMap map(config);
  for (const Rectangle& r : world.rectangles()) {
    PointCloud cloud;
    constexpr double step_m = 0.1;
    const double du = step_m / r.half_u_W.norm(), dv = step_m / r.half_v_W.norm();
    for (double u = -1.0; u <= 1.0; u += du)
      for (double v = -1.0; v <= 1.0; v += dv)
        cloud.points_I.push_back((r.center_W + u * r.half_u_W + v * r.half_v_W).cast<float>());
    map.insert(cloud, SE3::Identity());
  }
  return map;
}

TEST(Consistency, WithAKnownMapTheNeesOfThePoseIsChiSquared) {
  // Right noise model, right map, every point independent: nothing is left to tune.
  constexpr int runs = 50;
  double mean_nees = 0.0;
  for (int seed = 1; seed <= runs; ++seed) {
    auto simulation = open_simulation("sim:box_room?duration=6&lidar=ring16&seed=" + std::to_string(seed));
    ASSERT_TRUE(simulation);
    const Rig rig = simulation->rig();
    const PlaneMap map = known_map(simulation->boxes(), {.voxel_m = 0.4, .max_thickness = 0.0005});
    const PlaneResidualConfig every_point{.huber = 0.0, .gate = 3.5, .max_information = 0.0, .plane_points = 1e9};
    test::Random random(static_cast<unsigned>(seed));
    Arena arena(2);
    PacketAssembler assembler(rig);
    std::optional<Estimate> estimate;
    while (const auto event = simulation->next().value()) {
      if (const auto* imu = std::get_if<ImuSample>(&event->data)) assembler.push(*imu);
      if (const auto* scan = std::get_if<LidarScan>(&event->data)) assembler.push(*scan);
      while (auto packet = assembler.pop()) {
        if (!estimate) {  // a start drawn from its own covariance
          const Time begin = packet->scan->start;
          const MotionState truth = simulation->motion().at(begin);
          Vector18 sigma;
          sigma << Vector3d::Constant(0.01), Vector3d::Constant(0.02), Vector3d::Constant(0.02),
              Vector3d::Constant(rig.imu.gyro_bias_sigma), Vector3d::Constant(rig.imu.accel_bias_sigma),
              Vector3d::Constant(0.01);
          NavState state;
          state.time = begin;
          const SO3 R_W_I = truth.T_W_I.asSO3();
          state.R_W_I = R_W_I;
          state.p_W = truth.T_W_I.translation();
          state.v_W = truth.v_W;
          state.gravity_W = Vector3d(0.0, 0.0, -9.81);
          Vector18 error = Vector18::NullaryExpr([&] { return random.normal(); }).cwiseProduct(sigma);
          error.segment<6>(ix::bg).setZero();  // the simulator has drawn the biases
          estimate = Estimate{.mean = boxplus(state, error), .covariance = sigma.cwiseAbs2().asDiagonal()};
        }
        const Propagation motion = propagate(*estimate, packet->imu, packet->end, rig.imu, {}, packet->scan->start);
        const PointCloud cloud = downsample(deskew(*packet->scan, motion.path, rig.T_I_L, rig.lidar), 0.4);
        PlaneResiduals residuals(cloud, map, rig, motion.sweep.estimate.covariance.topLeftCorner<6, 6>(), every_point,
                                 arena);
        const auto update =
            iterated_update(motion.sweep.estimate, [&](const NavState& x) { return residuals(x).sums; }, {});
        ASSERT_GT(update.last.inliers, 100) << update.last.candidates << " of " << cloud.points_I.size() << " at "
                                            << to_seconds(packet->end.time_since_epoch());
        estimate = at_end(motion, update).estimate;
      }
    }
    const SE3 truth = simulation->motion().at(estimate->mean.time).T_W_I;
    Vector6 error;
    error << log_so3(estimate->mean.R_W_I.inverse() * truth.asSO3()), truth.translation() - estimate->mean.p_W;
    const Matrix6 P = estimate->covariance.topLeftCorner<6, 6>();
    const double nees = error.dot(P.ldlt().solve(error));
    RecordProperty("nees_" + std::to_string(seed), std::to_string(nees));
    mean_nees += nees / runs;
  }
  RecordProperty("mean_nees", std::to_string(mean_nees));
  // 95 % bounds of chi-square with 300 degrees of freedom over 50.
  EXPECT_GT(mean_nees, 5.08);
  EXPECT_LT(mean_nees, 7.00);
}

TEST(Consistency, WithItsOwnMapRelativePosesOverTenMetresAreAsGoodAsClaimed) {
  Config config;
  config.drift.scale_share = config.drift.turn_share = 0.0;  // these LiDARs have no faults of their own
  for (const std::string scene : {"room", "street"}) {
    Vector6 squares = Vector6::Zero(), claimed = Vector6::Zero();
    int count = 0;
    for (int seed = 501; seed <= 512; ++seed) {
      const auto run =
          test::run_simulation("sim:box_" + scene + "?duration=30&lidar=ring16&seed=" + std::to_string(seed), config);
      ASSERT_TRUE(run.result) << run.result.error().message;
      std::vector<double> distance_m{0.0};
      for (std::size_t i = 1; i < run.frames.size(); ++i)
        distance_m.push_back(distance_m.back() +
                             (run.frames[i].posterior.mean.p_W - run.frames[i - 1].posterior.mean.p_W).norm());
      for (std::size_t a = 0, b = 0; a < run.frames.size(); a += 10) {
        while (b < run.frames.size() && distance_m[b] < distance_m[a] + 10.0) ++b;
        if (b == run.frames.size()) break;
        const Vector6 error = test::relative_error_W(run, run.frames[a], run.frames[b]);
        const Matrix6 P = relative_pose_covariance(run.frames[a], run.frames[b]);
        for (int i = 0; i < 6; ++i) squares[i] += error[i] * error[i] / P(i, i);
        claimed += P.diagonal();
        ++count;
      }
    }
    ASSERT_GT(count, 100);
    for (int i = 0; i < 6; ++i) {
      const double normalised = std::sqrt(squares[i] / count);
      RecordProperty(scene + "_axis_" + std::to_string(i), std::to_string(normalised));
      RecordProperty(scene + "_sigma_" + std::to_string(i), std::to_string(std::sqrt(claimed[i] / count)));
      EXPECT_GT(normalised, 0.3) << scene << ", axis " << i << " of (theta, p)";
      EXPECT_LT(normalised, 3.0) << scene << ", axis " << i << " of (theta, p)";
    }
  }
}

TEST(Consistency, AlongAnEndlessCorridorTheSigmaGrowsAndCoversTheError) {
  int covered = 0, frames = 0;
  for (int seed = 601; seed <= 610; ++seed) {
    const auto run = test::run_simulation("sim:box_corridor?duration=25&lidar=ring16&seed=" + std::to_string(seed));
    ASSERT_TRUE(run.result) << run.result.error().message;
    const FrameEstimate& first = run.frames.front();
    double sigma_early = 0.0, sigma_late = 0.0;
    for (const FrameEstimate& frame : run.frames) {
      const Vector6 error = test::relative_error_W(run, first, frame);
      const double sigma = std::sqrt(frame.pose_covariance()(ix::p, ix::p));
      covered += std::abs(error[ix::p]) <= 1.96 * sigma;
      ++frames;
      const double t = to_seconds(frame.posterior.mean.time - first.posterior.mean.time);
      if (t > 7.0 && sigma_early == 0.0) sigma_early = sigma;
      sigma_late = sigma;
    }
    RecordProperty("corridor_" + std::to_string(seed),
                   std::to_string(test::relative_error_W(run, first, run.frames.back())[ix::p]) + " m at sigma " +
                       std::to_string(sigma_late) + " m");
    EXPECT_GT(sigma_late, 2.0 * sigma_early) << "seed " << seed;
    EXPECT_GT(run.summary.count(HealthState::degraded), static_cast<int>(run.frames.size()) / 2);
    EXPECT_EQ(run.summary.count(HealthState::lost), 0);
  }
  RecordProperty("covered", std::to_string(static_cast<double>(covered) / frames));
  EXPECT_GE(static_cast<double>(covered) / frames, 0.95);
}

}  // namespace
}  // namespace pllit
