#include "pllit/slam/time_offset.hpp"

#include <algorithm>
#include <cmath>
#include <format>
#include <limits>
#include <utility>

#include "pllit/base/arena.hpp"

namespace pllit {
namespace {

/// Motion that a hand-held or driven rig may have between two scans when nothing measures it.
constexpr GapModel free_motion{.max_gap = Duration{0}, .accel_sigma_mps2 = 10.0, .rate_sigma_rps = 1.5};

/// Integral of the angular rate from the first sample on, at any time: differences are mean rotations.
class TurnedAngle {
 public:
  explicit TurnedAngle(std::span<const ImuSample> imu) : imu_(imu), sum_(imu.size(), Vector3d::Zero()) {
    for (std::size_t i = 1; i < imu.size(); ++i)
      sum_[i] = sum_[i - 1] + 0.5 * (imu[i].gyro_rps + imu[i - 1].gyro_rps) * to_seconds(imu[i].time - imu[i - 1].time);
  }
  bool covers(Time time) const { return time >= imu_.front().time && time <= imu_.back().time; }
  Vector3d at(Time time) const {
    const auto after = std::ranges::upper_bound(imu_, time, {}, &ImuSample::time);
    const std::size_t i = std::clamp<std::size_t>(static_cast<std::size_t>(after - imu_.begin()), 1, imu_.size() - 1);
    const double s = to_seconds(time - imu_[i - 1].time) / to_seconds(imu_[i].time - imu_[i - 1].time);
    return (1.0 - s) * sum_[i - 1] + s * sum_[i];
  }

 private:
  std::span<const ImuSample> imu_;
  std::vector<Vector3d> sum_;
};

struct Misfit {
  double mean_square = std::numeric_limits<double>::infinity();  ///< (rad/s)^2
  int count = 0;
};

/// Mean squared difference of the two rates at an offset; a
/// constant difference is the gyroscope's bias and does not count.
Misfit misfit_at(double offset_s, const TurnedAngle& gyro, std::span<const LidarRotation> rotations) {
  const Duration offset = from_seconds(offset_s);
  std::vector<Vector3d> differences;
  Vector3d mean = Vector3d::Zero();
  for (const LidarRotation& r : rotations) {
    if (!gyro.covers(r.from + offset) || !gyro.covers(r.to + offset)) continue;
    differences.push_back((gyro.at(r.to + offset) - gyro.at(r.from + offset) - r.angle_I) / to_seconds(r.to - r.from));
    mean += differences.back();
  }
  if (differences.empty()) return {};
  mean /= static_cast<double>(differences.size());
  double sum = 0.0;
  for (const Vector3d& d : differences) sum += std::min((d - mean).squaredNorm(), 0.25);  // a mismatch counts once
  return {sum / static_cast<double>(differences.size()), static_cast<int>(differences.size())};
}

double spread_rps(std::span<const LidarRotation> rotations) {
  Vector3d mean = Vector3d::Zero(), square = Vector3d::Zero();
  for (const LidarRotation& r : rotations) {
    const Vector3d rate = r.angle_I / to_seconds(r.to - r.from);
    mean += rate / static_cast<double>(rotations.size());
    square += rate.cwiseAbs2() / static_cast<double>(rotations.size());
  }
  return std::sqrt(std::max(0.0, (square - mean.cwiseAbs2()).sum()));
}

Time middle_of(const LidarScan& scan) { return scan.start + (scan.end() - scan.start) / 2; }

/// Mean rate of the rotations that end and begin at a time.
std::optional<Vector3d> rate_around(Time time, std::span<const LidarRotation> rotations) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  const auto add = [&](const LidarRotation& r) {
    sum += r.angle_I / to_seconds(r.to - r.from);
    ++count;
  };
  const auto ending = std::ranges::lower_bound(rotations, time, {}, &LidarRotation::to);
  const auto beginning = std::ranges::lower_bound(rotations, time, {}, &LidarRotation::from);
  if (ending != rotations.end() && ending->to == time) add(*ending);
  if (beginning != rotations.end() && beginning->from == time) add(*beginning);
  return count > 0 ? std::optional<Vector3d>(sum / count) : std::nullopt;
}

/// LiDAR-only odometry: constant velocity and rate from scan to scan, as no IMU may have a say.
class LidarOdometry {
 public:
  LidarOdometry(const Rig& rig, const Config& config)
      : rig_(rig), config_(config), map_(config.map), arena_(config.threads) {
    estimate_.covariance.diagonal().setConstant(1e-6);
  }

  /// The rotation since the scan before, where both were matched. A scan tells the mean pose of its sweep, so it is one
  /// from the middle of a sweep to the middle of the next. `known_rate`: of the sweep, from an earlier pass; else the
  /// last one is taken.
  std::optional<LidarRotation> add(const LidarScan& scan, const std::optional<Vector3d>& known_rate) {
    if (known_rate) rate_I_ = *known_rate;
    const bool first = map_.voxels() == 0;
    if (!first) predict(scan.end());
    estimate_.mean.time = scan.end();
    const PointCloud cloud = downsample(deskewed(scan), config_.scan.insert_voxels * config_.map.voxel_m);
    const bool matched = !first && match(cloud);
    if (!matched && !first) {
      last_.reset();
      return std::nullopt;
    }
    map_.insert(cloud, estimate_.mean.T_W_I());
    map_.slide(estimate_.mean.p_W);
    const double to_middle_s = to_seconds(middle_of(scan) - scan.end());
    const Orientation middle{middle_of(scan), estimate_.mean.R_W_I * exp_so3(rate_I_ * to_middle_s)};
    const auto before = std::exchange(last_, middle);
    if (!before) return std::nullopt;
    const LidarRotation rotation{before->time, middle.time, log_so3(before->R_W_I.inverse() * middle.R_W_I)};
    rate_I_ = rotation.angle_I / to_seconds(rotation.to - rotation.from);
    return rotation;
  }

 private:
  void predict(Time until) {
    const double dt = to_seconds(until - estimate_.mean.time);
    estimate_ = propagate(estimate_, {}, until, rig_.imu, free_motion).predicted;
    estimate_.mean.R_W_I = estimate_.mean.R_W_I * exp_so3(rate_I_ * dt);
  }

  PointCloud deskewed(const LidarScan& scan) const {
    PathNode node{.time = scan.start,
                  .R_W_I = SO3::Identity(),
                  .p_W = Vector3d::Zero(),
                  .v_W = estimate_.mean.R_W_I.inverse().act(estimate_.mean.v_W),
                  .omega_I = rate_I_,
                  .accel_W = Vector3d::Zero()};
    PathNode end = node;
    const SE3 T_start_end = extrapolate(node, to_seconds(scan.end() - scan.start));
    end.time = scan.end();
    end.R_W_I = rotation_from(T_start_end.quat());
    end.p_W = T_start_end.translation();
    return deskew(scan, MotionPath{{node, end}}, rig_.T_I_L, rig_.lidar);
  }

  bool match(const PointCloud& cloud) {
    const PointCloud points = thin(cloud, static_cast<std::size_t>(config_.scan.max_matched));
    PlaneResiduals residuals(points, map_, rig_, estimate_.covariance.topLeftCorner<6, 6>(), config_.planes, arena_);
    const auto linearize = [&](const NavState& x) {
      return observed_part(residuals(x), x.R_W_I, {}, config_.degeneracy).sums;
    };
    const UpdateResult update = iterated_update(estimate_, linearize, config_.filter);
    if (!match_accepted(update.last, config_.health)) return false;
    estimate_ = update.posterior;
    return true;
  }

  const Rig& rig_;
  const Config& config_;
  PlaneMap map_;
  Arena arena_;
  Estimate estimate_;
  Vector3d rate_I_ = Vector3d::Zero();
  struct Orientation {
    Time time;
    SO3 R_W_I;
  };
  std::optional<Orientation> last_;  ///< in the middle of the last sweep, where it was matched
};

}  // namespace

std::vector<LidarRotation> lidar_rotations(std::span<const LidarScan> scans, const Rig& rig, const Config& config) {
  std::vector<LidarRotation> rotations;
  std::vector<std::optional<Vector3d>> rates(scans.size());
  // The rate of the last scan lags behind; the mean of those on both sides, known in the next pass, does not.
  for (int pass = 0; pass < 3; ++pass) {
    rotations.clear();
    LidarOdometry odometry(rig, config);
    for (std::size_t i = 0; i < scans.size(); ++i)
      if (const auto rotation = odometry.add(scans[i], rates[i])) rotations.push_back(*rotation);
    for (std::size_t i = 0; i < scans.size(); ++i) rates[i] = rate_around(middle_of(scans[i]), rotations);
  }
  return rotations;
}

TimeOffset estimate_time_offset(std::span<const ImuSample> imu, std::span<const LidarRotation> rotations,
                                double range_s) {
  constexpr double min_spread_rps = 0.03, step_s = 0.001;
  TimeOffset result;
  if (imu.size() < 10 || rotations.size() < 20) {
    result.reason = "too few scans and IMU samples that belong together";
    return result;
  }
  if (const double spread = spread_rps(rotations); spread < min_spread_rps) {
    result.reason = std::format("the rig turns too evenly to tell (rate varies by {:.3f} rad/s)", spread);
    return result;
  }
  const TurnedAngle gyro(imu);
  const int steps = static_cast<int>(std::lround(range_s / step_s));
  std::vector<Misfit> misfits;
  for (int i = -steps; i <= steps; ++i) misfits.push_back(misfit_at(i * step_s, gyro, rotations));
  const auto best = std::ranges::min_element(misfits, {}, &Misfit::mean_square);
  const auto index = static_cast<int>(best - misfits.begin());
  if (best->count < 20 || index == 0 || index == 2 * steps) {
    result.reason = std::format(
        "no agreement between gyroscope and LiDAR within {:.1f} s; check clocks and rig.lidar.T_I_L", range_s);
    return result;
  }
  // The lowest point of the parabola through the best offset and its neighbours.
  const double a = misfits[index - 1].mean_square, b = best->mean_square, c = misfits[index + 1].mean_square;
  const double curvature = a - 2.0 * b + c;
  result.found = true;
  result.offset_s = (index - steps + (curvature > 0.0 ? 0.5 * (a - c) / curvature : 0.0)) * step_s;
  result.residual_rps = std::sqrt(b);
  return result;
}

}  // namespace pllit
