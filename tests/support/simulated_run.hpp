// Runs the odometry on a simulation and keeps what tests look at.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pllit/sim/simulation.hpp"
#include "pllit/slam/run.hpp"

namespace pllit::test {

struct SimulatedRun {
  Expected<void> result;
  RunSummary summary;
  std::vector<FrameEstimate> frames;  ///< without their clouds
  Motion motion;

  SE3 truth_at(const FrameEstimate& frame) const { return motion.at(frame.posterior.mean.time).T_W_I; }
};

/// `address` is one that exists; configuration errors fail the test. `camera_early`: the delay that the camera is said
/// to have is so much more than its own.
inline SimulatedRun run_simulation(const std::string& address, const Config& config = {}, Duration camera_early = {}) {
  auto simulation = open_simulation(address);
  EXPECT_TRUE(simulation.has_value()) << simulation.error().message;
  SimulatedRun run{.result = {}, .summary = {}, .frames = {}, .motion = simulation->motion()};
  const RunHooks hooks{.sink = [&run](const FrameEstimate& frame) -> Expected<void> {
    run.frames.push_back(frame);
    run.frames.back().cloud = {};
    return {};
  }};
  Rig rig = simulation->rig();
  rig.camera_delay += camera_early;
  run.result = run_odometry(*simulation, rig, config, hooks, run.summary);
  return run;
}

/// The estimated motion between two frames against the true one, as (theta, p) in W about the first frame's position.
inline Vector6 relative_error_W(const SimulatedRun& run, const FrameEstimate& a, const FrameEstimate& b) {
  const SE3 estimated = a.posterior.mean.T_W_I().inverse() * b.posterior.mean.T_W_I();
  const SE3 truth = run.truth_at(a).inverse() * run.truth_at(b);
  const Matrix3d R_W_a = a.posterior.mean.R_W_I.rotation();
  Vector6 error;
  error << R_W_a * log_so3(estimated.asSO3() * truth.asSO3().inverse()),
      R_W_a * (estimated.translation() - truth.translation());
  return error;
}

}  // namespace pllit::test
