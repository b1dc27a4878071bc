// Runs the odometry on a simulation and keeps what tests look at.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pllit/eval/rpe.hpp"
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

/// The estimated motion between two frames against the true one, (theta, p) in W.
inline Vector6 relative_error_W(const SimulatedRun& run, const FrameEstimate& a, const FrameEstimate& b) {
  const auto matched = [&run](const FrameEstimate& frame) {
    const NavState& mean = frame.posterior.mean;
    return PosePair{.time = mean.time, .T_W_I = run.truth_at(frame), .T_V_I = mean.T_W_I()};
  };
  return motion_error_V(matched(a), matched(b));
}

}  // namespace pllit::test
