#include "pllit/slam/time_offset.hpp"

#include <algorithm>
#include <cmath>
#include <format>
#include <limits>

#include "pllit/base/arena.hpp"

namespace pllit {
namespace {

namespace ix = error_index;

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

/// Mean squared difference of the two rates at an offset; a constant difference is the gyroscope's bias and does not count.
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

}  // namespace

std::vector<LidarRotation> lidar_rotations(std::span<const LidarScan> scans, const Rig& rig, const Config& config) {
  std::vector<LidarRotation> rotations;
  PlaneMap map(config.map);
  Arena arena(config.threads > 0 ? config.threads : 2);
  Estimate estimate;
  estimate.covariance.diagonal().setConstant(1e-6);
  std::optional<Estimate> last;  // of the last matched scan
  Time last_middle;
  for (const LidarScan& scan : scans) {
    const Time middle = middle_of(scan);
    if (map.voxels() > 0) estimate = propagate(estimate, {}, middle, rig.imu, free_motion).predicted;
    estimate.mean.time = middle;
    // Without a gyroscope there is no de-skew: all points count as measured in the middle of the sweep.
    const MotionPath still{{PathNode{scan.start, SO3::Identity(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()}}};
    const PointCloud cloud = downsample(deskew(scan, still, rig.T_I_L, rig.lidar), config.scan.insert_voxels * config.map.voxel_m);
    bool matched = false;
    if (map.voxels() > 0) {
      const PointCloud points = thin(cloud, static_cast<std::size_t>(config.scan.max_matched));
      PlaneResiduals residuals(points, map, rig, estimate.covariance.topLeftCorner<6, 6>(), config.planes, arena);
      const auto update = iterated_update(
          estimate, [&](const NavState& x) { return observed_part(residuals(x), x.R_W_I, {}, config.degeneracy).sums; }, config.filter);
      matched = match_accepted(update.last, config.health);
      if (matched) estimate = update.posterior;
    }
    if (matched && last)
      rotations.push_back({last_middle, middle, log_so3(last->mean.R_W_I.inverse() * estimate.mean.R_W_I)});
    if (matched || map.voxels() == 0) {
      map.insert(cloud, estimate.mean.T_W_I());
      map.slide(estimate.mean.p_W);
      last = estimate;
      last_middle = middle;
    } else {
      last.reset();
    }
  }
  return rotations;
}

TimeOffset estimate_time_offset(std::span<const ImuSample> imu, std::span<const LidarRotation> rotations, double range_s) {
  constexpr double min_spread_rps = 0.03, step_s = 0.005;
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
    result.reason = std::format("no agreement between gyroscope and LiDAR within {:.1f} s; check clocks and rig.lidar.T_I_L", range_s);
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
