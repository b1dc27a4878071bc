#include "pllit/sim/motion/fit.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <format>
#include <numbers>
#include <numeric>
#include <span>

#include "pllit/sim/motion/quintic_basis.hpp"

namespace pllit {
namespace {

constexpr std::array<double, 4> kThirdDifference{-1.0, 3.0, -3.0, 1.0};
using Tangents = Eigen::Matrix<double, Eigen::Dynamic, 6>;  // a row a control: rotation and translation, both in W

Expected<void> check(const Trajectory& path, const FitConfig& config) {
  if (path.size() < 4 || path.back().time - path.front().time < std::chrono::seconds(1))
    return input_error(
        std::format("a path of {} poses is too short for a motion: at least four poses over one second "
                    "are needed",
                    path.size()));
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!path[i].T_W_I.coeffs().allFinite()) return input_error(std::format("pose {} of the path is not finite", i));
    if (i == 0) continue;
    const double gap_s = to_seconds(path[i].time - path[i - 1].time);
    if (gap_s <= 0.0)
      return input_error(std::format("pose {} of the path is not later than the one before; remove duplicates", i));
    if (gap_s > config.max_gap_s)
      return input_error(
          std::format("the path has a gap of {:.1f} s before pose {}, more than the {:.1f} s that can be "
                      "bridged; cut the path there",
                      gap_s, i, config.max_gap_s));
    const double turn_rad = log_so3(path[i - 1].T_W_I.asSO3().inverse() * path[i].T_W_I.asSO3()).norm();
    if (turn_rad > 2.0 * std::numbers::pi / 3.0)
      return input_error(
          std::format("the path turns by {:.0f} deg at pose {}: which way is not certain; give poses at "
                      "a higher rate",
                      turn_rad * 180.0 / std::numbers::pi, i));
  }
  return {};
}

/// Weights of the six controls at one pose's time.
struct Row {
  std::size_t first;
  std::array<double, quintic::kOrder> weights;
};

Row row_at(double segments_elapsed, std::size_t segments) {
  const auto [segment, u] = quintic::place_of(segments_elapsed, segments);
  Row row{segment, {}};
  double before = 1.0;
  for (std::size_t j = 0; j < quintic::kCumulativeBasis.size(); ++j) {
    const double lambda = quintic::weight_at(quintic::kCumulativeBasis[j], u).value;
    row.weights[j] = before - lambda;
    before = lambda;
  }
  row.weights.back() = before;
  return row;
}

/// One row and column a control, half bandwidth five: sum of the rows' outer products and of the penalty's.
Eigen::SparseMatrix<double> normal_matrix(const std::vector<Row>& rows, std::size_t controls, double penalty) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add_outer = [&](std::size_t first, const auto& weights, double scale) {
    for (std::size_t i = 0; i < weights.size(); ++i)
      for (std::size_t j = 0; j < weights.size(); ++j)
        entries.emplace_back(static_cast<int>(first + i), static_cast<int>(first + j), scale * weights[i] * weights[j]);
  };
  for (const Row& row : rows) add_outer(row.first, row.weights, 1.0);
  for (std::size_t k = 0; k + 3 < controls; ++k) add_outer(k, kThirdDifference, penalty);
  const auto size = static_cast<Eigen::Index>(controls);
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// What is left of the pose, in W: Exp(rotation) R_fit = R_pose and p_fit + translation = p_pose.
Eigen::Matrix<double, 1, 6> residual(const SE3& fit, const SE3& pose) {
  Eigen::Matrix<double, 1, 6> r;
  r << log_so3(pose.asSO3() * fit.asSO3().inverse()).transpose(), (pose.translation() - fit.translation()).transpose();
  return r;
}

/// Third differences of the controls, taken as second differences of the steps between them.
Tangents third_differences(const std::vector<SE3>& controls) {
  const auto count = static_cast<Eigen::Index>(controls.size());
  Tangents steps(count - 1, 6);
  for (Eigen::Index i = 0; i + 1 < count; ++i)
    steps.row(i) = residual(controls[static_cast<std::size_t>(i)], controls[static_cast<std::size_t>(i + 1)]);
  return steps.bottomRows(count - 3) - 2.0 * steps.middleRows(1, count - 3) + steps.topRows(count - 3);
}

Tangents right_side(const Trajectory& path, const std::vector<Row>& rows, const Motion& motion,
                    const std::vector<SE3>& controls, double penalty) {
  Tangents sum = Tangents::Zero(static_cast<Eigen::Index>(controls.size()), 6);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto r = residual(motion.at(path[i].time).T_W_I, path[i].T_W_I);
    for (std::size_t j = 0; j < rows[i].weights.size(); ++j)
      sum.row(static_cast<Eigen::Index>(rows[i].first + j)) += rows[i].weights[j] * r;
  }
  const Tangents differences = third_differences(controls);
  for (Eigen::Index k = 0; k < differences.rows(); ++k)
    for (std::size_t j = 0; j < kThirdDifference.size(); ++j)
      sum.row(k + static_cast<Eigen::Index>(j)) -= penalty * kThirdDifference[j] * differences.row(k);
  return sum;
}

double median_period_s(const Trajectory& path) {
  std::vector<double> periods;
  for (std::size_t i = 1; i < path.size(); ++i) periods.push_back(to_seconds(path[i].time - path[i - 1].time));
  std::nth_element(periods.begin(), periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2), periods.end());
  return periods[periods.size() / 2];
}

std::vector<SE3> first_controls(const Trajectory& path, Duration spacing, std::size_t segments) {
  std::vector<SE3> controls;
  for (std::size_t i = 0; i < segments + 5; ++i) {
    const Time time = path.front().time + (static_cast<std::int64_t>(i) - 2) * spacing;
    controls.push_back(*pose_at(path, std::clamp(time, path.front().time, path.back().time), Duration::max()));
  }
  return controls;
}

/// At each pose what `choose` makes of the values within three seconds of it.
template <class Choose>
std::vector<double> windowed(const Trajectory& path, const std::vector<double>& values, const Choose& choose) {
  const Duration half = std::chrono::seconds(3);
  std::vector<double> chosen;
  for (std::size_t i = 0, first = 0, last = 0; i < path.size(); ++i) {
    while (path[i].time - path[first].time > half) ++first;
    while (last < path.size() && path[last].time - path[i].time <= half) ++last;
    chosen.push_back(choose(std::span(values).subspan(first, last - first)));
  }
  return chosen;
}

FitDistance distance_between(const Trajectory& path, const Motion& motion) {
  FitDistance distance;
  for (const StampedPose& pose : path) {
    const auto r = residual(motion.at(pose.time).T_W_I, pose.T_W_I);
    const double rotation_rad = r.head<3>().norm(), position_m = r.tail<3>().norm();
    distance.rotation_rms_rad += rotation_rad * rotation_rad / static_cast<double>(path.size());
    distance.position_rms_m += position_m * position_m / static_cast<double>(path.size());
    distance.rotation_max_rad = std::max(distance.rotation_max_rad, rotation_rad);
    distance.position_max_m = std::max(distance.position_max_m, position_m);
  }
  distance.rotation_rms_rad = std::sqrt(distance.rotation_rms_rad);
  distance.position_rms_m = std::sqrt(distance.position_rms_m);
  return distance;
}

}  // namespace

Expected<FittedMotion> fit_motion(const Trajectory& path, const FitConfig& config) {
  if (const auto checked = check(path, config); !checked) return std::unexpected(checked.error());
  const Duration spacing = from_seconds(config.spacing_s);
  const Time start = path.front().time;
  const auto segments = static_cast<std::size_t>((path.back().time - start + spacing - Duration(1)) / spacing);
  std::vector<Row> rows;
  for (const StampedPose& pose : path)
    rows.push_back(row_at(to_seconds(pose.time - start) / config.spacing_s, segments));

  // The penalty on the integral of the squared third derivative, against one pose a median period.
  const double cutoff_rps = 2.0 * std::numbers::pi * config.cutoff_hz;
  const double penalty = 1.0 / (std::pow(cutoff_rps, 6) * std::pow(config.spacing_s, 5) * median_period_s(path));
  std::vector<SE3> controls = first_controls(path, spacing, segments);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal_matrix(rows, controls.size(), penalty));
  if (solver.info() != Eigen::Success) return failure("the fit of a motion to the path has no unique solution");

  // Turning a control by d in W turns the spline by its weight times d, to first order: the same matrix serves
  // positions, which are done after one step, and rotations, which take a few.
  for (int iteration = 0; iteration < 15; ++iteration) {
    const Tangents change = solver.solve(right_side(path, rows, Motion(start, spacing, controls), controls, penalty));
    for (std::size_t i = 0; i < controls.size(); ++i) {
      const auto row = change.row(static_cast<Eigen::Index>(i));
      controls[i] = pose_from(exp_so3(row.head<3>().transpose()) * controls[i].asSO3(),
                              controls[i].translation() + row.tail<3>().transpose());
    }
    if (change.cwiseAbs().maxCoeff() < 1e-9) break;
  }
  Motion motion(start, spacing, controls);
  const FitDistance distance = distance_between(path, motion);
  return FittedMotion{std::move(motion), distance};
}

Expected<FittedMotion> motion_along(const Trajectory& path, const FitConfig& config) {
  constexpr double kMaxStartAcceleration_mps2 = 2.5;
  auto fitted = fit_motion(path, config);
  if (!fitted) return fitted;
  // The pace rises fastest in the middle of the ramp, by 1.875 / ramp.
  const double first_speed_mps = fitted->motion.at(fitted->motion.start()).v_W.norm();
  fitted->motion = fitted->motion.after_rest(
      {.rest_s = 2.0, .ramp_s = std::max(1.5, 1.875 * first_speed_mps / kMaxStartAcceleration_mps2)});
  return fitted;
}

Expected<Trajectory> sped_up_within(const Trajectory& path, double factor, double max_acceleration_mps2,
                                    const FitConfig& config) {
  assert(factor >= 1.0 && max_acceleration_mps2 > 0.0);
  const auto fitted = fit_motion(path, config);
  if (!fitted) return std::unexpected(fitted.error());
  std::vector<double> allowed;
  for (const StampedPose& pose : path) {
    // Accelerations grow with the square of the factor.
    const double acceleration_mps2 = fitted->motion.at(pose.time).a_W.norm();
    allowed.push_back(std::clamp(std::sqrt(max_acceleration_mps2 / std::max(acceleration_mps2, 1e-6)), 1.0, factor));
  }
  // The mean of minima stays below what is allowed here, for every one of them has this pose in its window.
  const std::vector<double> least = windowed(path, allowed, [](auto window) { return std::ranges::min(window); });
  const std::vector<double> smooth = windowed(path, least, [](auto window) {
    return std::accumulate(window.begin(), window.end(), 0.0) / static_cast<double>(window.size());
  });
  Trajectory fast{path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double interval_s = to_seconds(path[i].time - path[i - 1].time) / (0.5 * (smooth[i] + smooth[i - 1]));
    fast.push_back({fast.back().time + from_seconds(interval_s), path[i].T_W_I});
  }
  return fast;
}

}  // namespace pllit
