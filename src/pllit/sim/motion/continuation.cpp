#include "pllit/sim/motion/continuation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "pllit/sim/motion/arcs.hpp"
#include "pllit/sim/motion/paths.hpp"
#include "pllit/sim/random.hpp"

namespace pllit {
namespace {

constexpr double kAcceleration_mps2 = 1.2;  // along connecting roads and streets
constexpr double kPeriod_s = 0.1;

double heading_of(const SO3& R) {
  const Vector3d ahead = R.act(Vector3d::UnitX());
  return std::atan2(ahead.y(), ahead.x());
}

SO3 yaw(double heading_rad) { return exp_so3({0.0, 0.0, heading_rad}); }

PlanePose on_plane(const SE3& T_W_I) { return {T_W_I.translation().head<2>(), heading_of(T_W_I.asSO3())}; }

/// Mean over the half second before or after the end.
double end_speed_mps(const Trajectory& path, bool at_start) {
  const Duration half_second = std::chrono::milliseconds(500);
  const StampedPose& end = at_start ? path.front() : path.back();
  const Time other = at_start ? end.time + half_second : end.time - half_second;
  return (pose_at(path, other, Duration::max())->translation() - end.T_W_I.translation()).norm() / 0.5;
}

struct SpeedLimits {
  double first_mps, top_mps, last_mps;
};

/// Distances driven at 10 Hz from 0 to length_m: from the first speed to the top and down to the last, never below a
/// walking pace. The last distance is length_m itself.
std::vector<double> distances(double length_m, const SpeedLimits& limits) {
  std::vector<double> driven{0.0};
  while (driven.back() < length_m) {
    const double s = driven.back();
    const double gaining = std::sqrt(limits.first_mps * limits.first_mps + 2.0 * kAcceleration_mps2 * s);
    const double braking = std::sqrt(limits.last_mps * limits.last_mps + 2.0 * kAcceleration_mps2 * (length_m - s));
    driven.push_back(s + kPeriod_s * std::max(1.0, std::min({gaining, braking, limits.top_mps})));
  }
  const double stretch = length_m / driven.back();
  for (double& s : driven) s *= stretch;
  return driven;
}

/// A road from the path's end to the start of `next`, both its ends left out.
Trajectory connecting_road(const Trajectory& path, const Trajectory& next, const ContinuationConfig& config) {
  const SE3 &from = path.back().T_W_I, &to = next.front().T_W_I;
  const ArcStraightArc road = connection(on_plane(from), on_plane(to), config.bend_radius_m);
  const SO3 tilt_from = yaw(-heading_of(from.asSO3())) * from.asSO3();
  const Vector3d tilt_change = log_so3(tilt_from.inverse() * yaw(-heading_of(to.asSO3())) * to.asSO3());
  const double climb_m = to.translation().z() - from.translation().z();

  Trajectory poses;
  for (const double s :
       distances(road.length_m(), {end_speed_mps(path, false), config.speed_mps, end_speed_mps(next, true)})) {
    const double x = road.length_m() > 0.0 ? s / road.length_m() : 1.0;
    const double done = x * x * x * (10.0 + x * (6.0 * x - 15.0));
    const PlanePose at = road.at(s);
    const SO3 R_W_I = yaw(at.heading_rad) * tilt_from * exp_so3(done * tilt_change);
    const double z_m = from.translation().z() + done * climb_m;
    const Duration elapsed = from_seconds(static_cast<double>(poses.size()) * kPeriod_s);
    poses.push_back({path.back().time + elapsed, pose_from(R_W_I, {at.position.x(), at.position.y(), z_m})});
  }
  return {poses.begin() + 1, poses.end() - 1};
}

/// Positions at least 20 m apart, for distances between drives.
std::vector<Eigen::Vector2d> outline(const Trajectory& path) {
  std::vector<Eigen::Vector2d> points;
  for (const StampedPose& pose : path) {
    const Eigen::Vector2d position = pose.T_W_I.translation().head<2>();
    if (points.empty() || (position - points.back()).norm() > 20.0) points.push_back(position);
  }
  return points;
}

bool apart(const std::vector<Eigen::Vector2d>& some, const std::vector<Eigen::Vector2d>& others, double distance_m) {
  return std::ranges::none_of(some, [&](const Eigen::Vector2d& a) {
    return std::ranges::any_of(
        others, [&](const Eigen::Vector2d& b) { return (a - b).squaredNorm() < distance_m * distance_m; });
  });
}

/// The turn about z and shift that bring `drive` clear of `before`, its start as near to the end of `before` as can be:
/// rings of places around that end, and on each the choice with the shortest road.
SE3 clear_of(const Trajectory& before, const Trajectory& drive, const ContinuationConfig& config) {
  const std::vector<Eigen::Vector2d> driven = outline(before), shape = outline(drive);
  const SE3& start = drive.front().T_W_I;
  const PlanePose end = on_plane(before.back().T_W_I);
  const double height_m = before.back().T_W_I.translation().z() - start.translation().z();
  const double reach_m = config.clearance_m + 20.0;  // outlines leave out up to 20 m
  constexpr int kDirections = 12;
  constexpr double kStep_rad = 2.0 * std::numbers::pi / kDirections;
  for (double away_m = 2.0 * config.bend_radius_m;; away_m += config.bend_radius_m) {
    std::optional<SE3> best;
    double shortest_m = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kDirections * kDirections; ++i) {
      const PlanePose place{end.position + away_m * direction(end.heading_rad + kStep_rad * (i / kDirections)),
                            end.heading_rad + kStep_rad * (i % kDirections)};
      const double road_m = connection(end, place, config.bend_radius_m).length_m();
      if (road_m >= shortest_m) continue;
      const SO3 turn = yaw(place.heading_rad - heading_of(start.asSO3()));
      const Vector3d turned_start = turn.act(start.translation());
      const Vector3d shift(place.position.x() - turned_start.x(), place.position.y() - turned_start.y(), height_m);
      std::vector<Eigen::Vector2d> there;
      for (const Eigen::Vector2d& point : shape)
        there.push_back((turn.act(Vector3d(point.x(), point.y(), 0.0)) + shift).head<2>());
      if (!apart(there, driven, reach_m)) continue;
      best = pose_from(turn, shift);
      shortest_m = road_m;
    }
    if (best) return *best;
  }
}

void append(Trajectory& path, const Trajectory& next, Duration pause) {
  const Duration delay = path.back().time + pause - next.front().time;
  for (const StampedPose& pose : next) path.push_back({pose.time + delay, pose.T_W_I});
}

}  // namespace

Trajectory continued(const Trajectory& path, const ContinuationConfig& config) {
  assert(path.size() >= 2 && path_length_m(path) > 1.0);
  Trajectory whole = path;
  while (path_length_m(whole) < config.length_m) {
    const Trajectory next =
        config.way == ContinuationConfig::Way::revisit ? path : moved(path, clear_of(whole, path, config));
    const Trajectory road = connecting_road(whole, next, config);
    if (!road.empty()) append(whole, road, from_seconds(kPeriod_s));
    append(whole, next, from_seconds(kPeriod_s));
  }
  return cut_to_length(whole, config.length_m);
}

Trajectory street_drive(const StreetDrive& config) {
  Random random(config.seed, 60);
  Trajectory path{{Time{}, SE3::Identity()}};
  PlanePose corner;
  double driven_m = 0.0;
  const auto drive = [&](double curvature_pm, double length_m, const SpeedLimits& limits) {
    for (const double s : distances(length_m, limits)) {
      if (s == 0.0) continue;
      const PlanePose at = along_arc(corner, curvature_pm, s);
      path.push_back({path.back().time + from_seconds(kPeriod_s),
                      pose_from(yaw(at.heading_rad), {at.position.x(), at.position.y(), 0.0})});
    }
    corner = along_arc(corner, curvature_pm, length_m);
    driven_m += length_m;
  };
  double speed_mps = config.speed_mps;
  while (driven_m < config.length_m) {
    // Headings within 75 deg of x: the drive always gains in x and never meets itself.
    const double radius_m = random.uniform(15.0, 60.0);
    const double turn_rad = random.uniform(-1.3, 1.3) - corner.heading_rad;
    const double bend_mps = std::min(config.speed_mps, std::sqrt(2.0 * radius_m));
    drive(0.0, random.uniform(60.0, 200.0), {speed_mps, config.speed_mps, bend_mps});
    drive(std::copysign(1.0 / radius_m, turn_rad), radius_m * std::abs(turn_rad), {bend_mps, bend_mps, bend_mps});
    speed_mps = bend_mps;
  }
  return cut_to_length(path, config.length_m);
}

}  // namespace pllit
