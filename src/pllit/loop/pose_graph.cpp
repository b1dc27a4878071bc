#include "pllit/loop/pose_graph.hpp"

#include <gtsam/nonlinear/LevenbergMarquardtOptimizer.h>

#include <algorithm>
#include <cmath>

#include "pllit/loop/gtsam_factors.hpp"

namespace pllit {
namespace {

gtsam::NonlinearFactorGraph trusted_factors(const PoseGraph& graph) {
  gtsam::NonlinearFactorGraph factors;
  factors.add(first_factor(graph.guesses_M.front(), graph.tilt_sigma_rad));
  for (const RelativePose& step : graph.odometry) factors.add(between_factor(step, noise_of(step)));
  for (const Upright& vertical : graph.verticals) factors.add(vertical_factor(vertical));
  return factors;
}

gtsam::Values to_values(const std::vector<SE3>& poses_M) {
  gtsam::Values values;
  for (std::size_t i = 0; i < poses_M.size(); ++i) values.insert(i, to_gtsam(poses_M[i]));
  return values;
}

std::vector<SE3> from_values(const gtsam::Values& values) {
  std::vector<SE3> poses_M;
  for (std::size_t i = 0; i < values.size(); ++i) poses_M.push_back(from_gtsam(values.at<gtsam::Pose3>(i)));
  return poses_M;
}

/// Minimises from where `poses_M` stand, loops weighted.
std::vector<SE3> minimise(const PoseGraph& graph, const gtsam::NonlinearFactorGraph& trusted,
                          const std::vector<SE3>& poses_M, const std::vector<double>& loop_weights, int iterations) {
  gtsam::NonlinearFactorGraph factors = trusted;
  for (std::size_t i = 0; i < graph.loops.size(); ++i)
    if (loop_weights[i] > 0.0)  // little is enough where the way between is hardly known
      factors.add(between_factor(graph.loops[i], noise_of(graph.loops[i], 1.0 / loop_weights[i])));
  gtsam::LevenbergMarquardtParams parameters;
  parameters.maxIterations = iterations;
  parameters.relativeErrorTol = 1e-7;
  parameters.absoluteErrorTol = 1e-9;
  return from_values(gtsam::LevenbergMarquardtOptimizer(factors, to_values(poses_M), parameters).optimize());
}

/// Weight of the surrogate of truncated least squares at control parameter mu (eq. 14 of Yang et al.).
double truncated_weight(double squared, double max_squared, double mu) {
  if (squared <= mu / (mu + 1.0) * max_squared) return 1.0;
  if (squared >= (mu + 1.0) / mu * max_squared) return 0.0;
  return std::sqrt(max_squared * mu * (mu + 1.0) / squared) - mu;
}

std::vector<double> squared_errors(const std::vector<RelativePose>& measured, const std::vector<SE3>& poses_M) {
  std::vector<double> squared;
  for (const RelativePose& loop : measured) squared.push_back(squared_error(loop, poses_M));
  return squared;
}

/// Graduated non-convexity. Begins where the surrogate is convex and loops that are far off weigh next to nothing; ends
/// where it is all but truncated least squares itself.
RobustSolution without_outliers(const PoseGraph& graph, const gtsam::NonlinearFactorGraph& trusted, double limit) {
  constexpr double kLastMu = 1e3, kGrowth = 4.0;
  RobustSolution solution{graph.guesses_M, std::vector(graph.loops.size(), 1.0)};
  std::vector<double> squared = squared_errors(graph.loops, solution.poses_M);
  const double worst = squared.empty() ? 0.0 : std::ranges::max(squared);
  if (worst <= 0.5 * limit) return solution;
  for (double mu = limit / (2.0 * worst - limit); mu < kLastMu; mu *= kGrowth) {
    for (std::size_t i = 0; i < squared.size(); ++i) solution.loop_weights[i] = truncated_weight(squared[i], limit, mu);
    solution.poses_M = minimise(graph, trusted, solution.poses_M, solution.loop_weights, 4);
    squared = squared_errors(graph.loops, solution.poses_M);
  }
  for (double& weight : solution.loop_weights) weight = weight > 0.5 ? 1.0 : 0.0;
  return solution;
}

/// By what factor, at most 1, the loops' squared errors are smaller than their covariances say, with a margin: where
/// noise is overstated a wrong loop can hide in it.
double noise_overstated(const PoseGraph& graph, const RobustSolution& solution) {
  constexpr std::size_t kFewest = 20;
  constexpr double kMedianOfChiSquare6 = 5.348, kMargin = 36.0;  // tails are heavy
  std::vector<double> squared;
  for (std::size_t i = 0; i < graph.loops.size(); ++i)
    if (solution.loop_weights[i] > 0.0) squared.push_back(squared_error(graph.loops[i], solution.poses_M));
  if (squared.size() < kFewest) return 1.0;
  const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
  std::ranges::nth_element(squared, middle);
  return std::min(1.0, kMargin * *middle / kMedianOfChiSquare6);
}

}  // namespace

double squared_error(const RelativePose& measured, const std::vector<SE3>& poses_M) {
  const SE3 T_from_to =
      poses_M[static_cast<std::size_t>(measured.from)].inverse() * poses_M[static_cast<std::size_t>(measured.to)];
  const Vector6 error = gtsam::Pose3::Logmap(to_gtsam(measured.T_from_to.inverse() * T_from_to));
  return error.dot(measured.covariance.llt().solve(error));
}

std::vector<SE3> optimised(const PoseGraph& graph) {
  return on_one_thread([&] {
    return minimise(graph, trusted_factors(graph), graph.guesses_M, std::vector<double>(graph.loops.size(), 1.0), 100);
  });
}

RobustSolution optimised_robustly(const PoseGraph& graph, double max_squared_error) {
  return on_one_thread([&] {
    const auto trusted = trusted_factors(graph);
    double limit = max_squared_error;
    RobustSolution solution = without_outliers(graph, trusted, limit);
    for (int round = 0; round < 2; ++round) {
      const double tighter = max_squared_error * noise_overstated(graph, solution);
      if (tighter > 0.5 * limit) break;
      limit = tighter;
      solution = without_outliers(graph, trusted, limit);
    }
    solution.poses_M = minimise(graph, trusted, solution.poses_M, solution.loop_weights, 50);
    return solution;
  });
}

}  // namespace pllit
