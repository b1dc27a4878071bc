#include "pllit/lidar/deskew.hpp"

#include <algorithm>

namespace pllit {
namespace {

/// Motion near one instant, seen from the frame I at the path's end: rotation and position then, and how they go on.
struct LocalMotion {
  Time time;
  Matrix3d R_end_I;
  Vector3d p_end;    ///< m
  Vector3d v_end;    ///< m/s
  Vector3d omega_I;  ///< rad/s
};

LocalMotion motion_at(const MotionPath& path, const SE3& T_end_W, Time time) {
  auto node = std::ranges::upper_bound(path.nodes, time, {}, &PathNode::time);
  if (node != path.nodes.begin()) --node;
  const double dt = to_seconds(time - node->time);
  const SE3 T_end_I = T_end_W * extrapolate(*node, dt);
  return {time, T_end_I.rotation(), T_end_I.translation(), T_end_W.rotation() * (node->v_W + node->accel_W * dt),
          node->omega_I};
}

/// R Exp(omega dt) p + p_end + v dt, to second order in the angle: dt stays below a millisecond.
Vector3d move(const LocalMotion& motion, double dt_s, const Vector3d& p_I) {
  const Vector3d phi = motion.omega_I * dt_s;
  const Vector3d turned = phi.cross(p_I);
  return motion.R_end_I * (p_I + turned + 0.5 * phi.cross(turned)) + motion.p_end + motion.v_end * dt_s;
}

}  // namespace

PointCloud deskew(const LidarScan& scan, const MotionPath& path, const SE3& T_I_L, const LidarModel& lidar) {
  constexpr Duration stride = std::chrono::microseconds(500);
  const SE3 T_end_W = pose_from(path.nodes.back().R_W_I, path.nodes.back().p_W).inverse();
  const Matrix3d R_I_L = T_I_L.rotation();
  const Vector3d p_I_L = T_I_L.translation();

  PointCloud cloud{.reference = path.nodes.back().time, .points_I = {}, .intensity = {}};
  cloud.points_I.reserve(scan.points_L.size());
  cloud.intensity.reserve(scan.points_L.size());
  LocalMotion motion = motion_at(path, T_end_W, scan.start);
  std::size_t next_node = 0;  // the motion changes at every node: the local motion must not reach across one
  for (std::size_t i = 0; i < scan.points_L.size(); ++i) {
    const double range = scan.points_L[i].cast<double>().norm();
    if (range < lidar.min_range_m || range > lidar.max_range_m) continue;
    const Time time = scan.start + scan.offsets[i];
    bool crossed = time - motion.time > stride;
    while (next_node < path.nodes.size() && path.nodes[next_node].time <= time) {
      ++next_node;
      crossed = true;
    }
    if (crossed) motion = motion_at(path, T_end_W, time);
    const Vector3d p_I = R_I_L * scan.points_L[i].cast<double>() + p_I_L;
    cloud.points_I.push_back(move(motion, to_seconds(time - motion.time), p_I).cast<float>());
    cloud.intensity.push_back(scan.intensity[i]);
  }
  return cloud;
}

}  // namespace pllit
