#include "pllit/sim/motion/paths.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace pllit {
namespace {

/// S R S for S = diag(1, -1, 1): a rotation again, for S is its own inverse.
SO3 mirrored(const SO3& R) {
  const Eigen::Quaterniond q = R.quat();
  return rotation_from(Eigen::Quaterniond(q.w(), -q.x(), q.y(), -q.z()));
}

/// x along the heading of x of I and up the slope, z along the ground's normal.
SO3 standing_on(const Eigen::Vector2d& slope, const SO3& R_W_I) {
  const Vector3d ahead = R_W_I.act(Vector3d::UnitX());
  const Vector3d x = Vector3d(ahead.x(), ahead.y(), slope.dot(ahead.head<2>())).normalized();
  const Vector3d z = Vector3d(-slope.x(), -slope.y(), 1.0).normalized();
  Matrix3d R;
  R << x, z.cross(x), z;
  return rotation_from(Eigen::Quaterniond(R));
}

}  // namespace

Trajectory sped_up(const Trajectory& path, double factor) {
  assert(factor > 0.0);
  Trajectory fast = path;
  for (StampedPose& pose : fast)
    pose.time = path.front().time + from_seconds(to_seconds(pose.time - path.front().time) / factor);
  return fast;
}

Trajectory mirrored(const Trajectory& path) {
  Trajectory other = path;
  for (StampedPose& pose : other) {
    const Vector3d p_W = pose.T_W_I.translation();
    pose.T_W_I = pose_from(mirrored(pose.T_W_I.asSO3()), {p_W.x(), -p_W.y(), p_W.z()});
  }
  return other;
}

Trajectory reversed(const Trajectory& path) {
  const SO3 half_turn = exp_so3({0.0, 0.0, std::numbers::pi});
  Trajectory back;
  for (auto pose = path.rbegin(); pose != path.rend(); ++pose)
    back.push_back({path.front().time + (path.back().time - pose->time),
                    pose_from(pose->T_W_I.asSO3() * half_turn, pose->T_W_I.translation())});
  return back;
}

Trajectory cut_to_duration(const Trajectory& path, double duration_s) {
  const auto end = std::ranges::find_if(
      path, [&](const StampedPose& pose) { return to_seconds(pose.time - path.front().time) > duration_s; });
  return {path.begin(), end};
}

Trajectory cut_to_length(const Trajectory& path, double length_m) {
  double travelled_m = 0.0;
  Trajectory cut;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) travelled_m += (path[i].T_W_I.translation() - path[i - 1].T_W_I.translation()).norm();
    if (i > 0 && travelled_m > length_m) break;
    cut.push_back(path[i]);
  }
  return cut;
}

Trajectory moved(const Trajectory& path, const SE3& T_V_W) {
  Trajectory there = path;
  for (StampedPose& pose : there) pose.T_W_I = T_V_W * pose.T_W_I;
  return there;
}

Trajectory on_ground(const Trajectory& path, const Ground& ground, double height_m, Stance stance) {
  Trajectory above = path;
  for (StampedPose& pose : above) {
    const Eigen::Vector2d position = pose.T_W_I.translation().head<2>();
    const SO3 R_W_I = pose.T_W_I.asSO3();
    pose.T_W_I = pose_from(stance == Stance::tilted ? standing_on(ground.slope(position), R_W_I) : R_W_I,
                           {position.x(), position.y(), ground.height_m(position) + height_m});
  }
  return above;
}

}  // namespace pllit
