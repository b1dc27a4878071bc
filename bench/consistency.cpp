// How large the errors of relative poses are against what the estimator says of them, over many seeds:
// bench_consistency [--way M] SEEDS CONFIG SIM_ADDRESS..., for example 30 hilti2022
// "sim:room?rig=hilti2022&images=none".
// A row an address: the root mean square of error over sigma of each axis of each 10 m (or M) of way (1 is right),
// turned along that way, and the mean of their squared Mahalanobis distance (6 is right), over all seeds and for the
// worst one.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>

#include "pllit/eval/rpe.hpp"
#include "pllit/sim/simulation.hpp"
#include "pllit/slam/config_presets.hpp"
#include "pllit/slam/run.hpp"

namespace pllit {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

struct Score {
  int poses = 0;
  Vector6 squares = Vector6::Zero();  ///< of error over sigma: roll, pitch, yaw; along, across, up
  Vector6 errors = Vector6::Zero();   ///< squared errors, rad and m
  double nees = 0.0;

  double mean_nees() const { return nees / std::max(1, poses); }
  Score& operator+=(const Score& other) {
    poses += other.poses;
    squares += other.squares;
    errors += other.errors;
    nees += other.nees;
    return *this;
  }
};

/// Turns W so that x points along the way from a to b.
Matrix6 along_the_way(const FrameEstimate& a, const FrameEstimate& b) {
  const Vector3d way_W = b.posterior.mean.p_W - a.posterior.mean.p_W;
  const Matrix3d R = exp_so3({0.0, 0.0, -std::atan2(way_W.y(), way_W.x())}).rotation();
  Matrix6 both = Matrix6::Zero();
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = R;
  return both;
}

PosePair matched(const FrameEstimate& frame, const SE3& truth) {
  const NavState& mean = frame.posterior.mean;
  return {.time = mean.time, .T_W_I = truth, .T_V_I = mean.T_W_I()};
}

void add(Score& score, const FrameEstimate& a, const FrameEstimate& b, const SE3& true_a, const SE3& true_b) {
  const Matrix6 turn = along_the_way(a, b);
  const Vector6 error = turn * motion_error_V(matched(a, true_a), matched(b, true_b));
  const Matrix6 covariance = turn * relative_pose_covariance(a, b) * turn.transpose();
  ++score.poses;
  score.squares += error.cwiseAbs2().cwiseQuotient(covariance.diagonal());
  score.errors += error.cwiseAbs2();
  score.nees += error.dot(covariance.ldlt().solve(error));
}

/// The score of one run; an error where it fails, or where the truth does not reach.
Expected<Score> score_of(const std::string& address, const Config& config, double each_m) {
  auto simulation = open_simulation(address);
  if (!simulation) return std::unexpected(simulation.error());
  const Trajectory truth = simulation->truth();
  Score score;
  std::optional<FrameEstimate> from;
  SE3 true_from;
  double way_m = 0.0;
  Vector3d last_W = Vector3d::Zero();
  const auto take = [&](const FrameEstimate& frame) -> Expected<void> {
    if (frame.health.state != HealthState::good && frame.health.state != HealthState::degraded) return {};
    const Vector3d& p_W = frame.posterior.mean.p_W;
    if (from) way_m += (p_W - last_W).norm();
    last_W = p_W;
    if (from && way_m < each_m) return {};
    const auto true_pose = pose_at(truth, frame.posterior.mean.time, std::chrono::milliseconds(50));
    if (!true_pose) return input_error("the truth has no pose at the time of a frame");
    if (from) add(score, *from, frame, true_from, *true_pose);
    true_from = *true_pose;
    from = frame;
    from->cloud = {};
    way_m = 0.0;
    return {};
  };
  RunSummary summary;
  const Rig rig = simulation->rig();
  const auto done = run_odometry(*simulation, rig, config, {.sink = take}, summary);
  if (!done) return std::unexpected(done.error());
  return score;
}

void print_row(const std::string& address, const Score& score, int worst_seed, double worst_nees) {
  const int poses = std::max(1, score.poses);
  const Vector6 rms = (score.squares / poses).cwiseSqrt(), errors = (score.errors / poses).cwiseSqrt();
  std::printf("| %s | %d", address.c_str(), score.poses);
  for (const double value : rms) std::printf(" | %.2f", value);
  std::printf(" | %.1f | %d: %.1f | %.3f, %.3f, %.3f | %.1f, %.1f, %.1f |\n", score.mean_nees(), worst_seed, worst_nees,
              kDegrees * errors[0], kDegrees * errors[1], kDegrees * errors[2], 1e3 * errors[3], 1e3 * errors[4],
              1e3 * errors[5]);
  std::fflush(stdout);
}

int run(double each_m, int seeds, const std::string& preset, const std::vector<std::string>& addresses) {
  const auto config = find_config(preset);
  if (!config) {
    std::fprintf(stderr, "%s\n", config.error().message.c_str());
    return 2;
  }
  std::printf(
      "| simulated | poses | roll | pitch | yaw | along | across | up | mean NEES | worst seed: its mean "
      "| rms error: roll, pitch, yaw, deg | along, across, up, mm "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& address : addresses) {
    Score all, worst;
    int worst_seed = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto score =
          score_of(address + (address.contains('?') ? "&" : "?") + "seed=" + std::to_string(seed), *config, each_m);
      if (!score) {
        std::fprintf(stderr, "%s, seed %d: %s\n", address.c_str(), seed, score.error().message.c_str());
        return 1;
      }
      if (score->mean_nees() > worst.mean_nees()) {
        worst = *score;
        worst_seed = seed;
      }
      all += *score;
    }
    print_row(address, all, worst_seed, worst.mean_nees());
  }
  return 0;
}

}  // namespace
}  // namespace pllit

int main(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  double each_m = 10.0;
  if (words.size() > 2 && words.front() == "--way") {
    each_m = std::atof(words[1].c_str());
    words.erase(words.begin(), words.begin() + 2);
  }
  const int seeds = words.size() > 2 ? std::atoi(words.front().c_str()) : 0;
  if (seeds <= 0 || each_m <= 0.0) {
    std::fprintf(stderr, "usage: bench_consistency [--way M] SEEDS CONFIG SIM_ADDRESS...\n");
    return 2;
  }
  return pllit::run(each_m, seeds, words[1], {words.begin() + 2, words.end()});
}
