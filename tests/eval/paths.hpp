// Paths that the tests of eval walk.
#pragma once

#include <numbers>
#include <random>
#include <vector>

#include "pllit/eval/associate.hpp"

namespace pllit::test {

inline double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }
inline Time at(double seconds) { return Time(from_seconds(seconds)); }
inline SO3 turn(const Vector3d& axis, double angle_deg) { return exp_so3(radians(angle_deg) * axis.normalized()); }
inline SO3 yaw(double angle_deg) { return turn(Vector3d::UnitZ(), angle_deg); }
inline SE3 moved_to(double x, double y, double z) { return pose_from(SO3::Identity(), Vector3d(x, y, z)); }

/// Truth and estimate as pairs, one second apart.
inline std::vector<PosePair> pairs_of(const std::vector<SE3>& truth, const std::vector<SE3>& estimate) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < truth.size(); ++i) pairs.push_back({at(static_cast<double>(i)), truth[i], estimate[i]});
  return pairs;
}

/// `count` poses one metre apart along x, without rotation.
inline std::vector<SE3> straight(int count) {
  std::vector<SE3> poses;
  for (int i = 0; i < count; ++i) poses.push_back(moved_to(i, 0.0, 0.0));
  return poses;
}

/// A random walk in three dimensions that turns all the while and stands still now and then.
inline std::vector<SE3> wandering(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> step_m(0.05, 0.6);
  std::vector<SE3> poses{SE3::Identity()};
  while (poses.size() < count) {
    const bool standing = poses.size() % 17 < 4;
    const Vector3d phi = 0.1 * Vector3d(normal(random), normal(random), normal(random));
    const Vector3d step(standing ? 0.0 : step_m(random), 0.0, 0.0);
    poses.push_back(poses.back() * pose_from(standing ? SO3::Identity() : exp_so3(phi), step));
  }
  return poses;
}

/// Every pose with a little rotation and translation added on its right, seeded.
inline std::vector<SE3> disturbed(std::vector<SE3> poses, double sigma_m, double sigma_rad, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (SE3& pose : poses) {
    const Vector3d shift = sigma_m * Vector3d(normal(random), normal(random), normal(random));
    pose = pose * pose_from(exp_so3(sigma_rad * Vector3d(normal(random), normal(random), normal(random))), shift);
  }
  return poses;
}

inline std::vector<SE3> seen_from(const SE3& T_V_W, std::vector<SE3> poses) {
  for (SE3& pose : poses) pose = T_V_W * pose;
  return poses;
}

/// A motion far from identity.
inline SE3 far_motion() { return pose_from(turn(Vector3d(0.3, -0.5, 0.8), 130.0), Vector3d(12.0, -7.0, 3.0)); }

inline Trajectory trajectory_of(const std::vector<SE3>& poses, double first_s, double step_s) {
  Trajectory trajectory;
  for (std::size_t i = 0; i < poses.size(); ++i)
    trajectory.push_back({at(first_s + step_s * static_cast<double>(i)), poses[i]});
  return trajectory;
}

}  // namespace pllit::test
