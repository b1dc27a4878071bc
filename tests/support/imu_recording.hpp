// Readers for the text recordings that only tests use.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "pllit/sensor/measurements.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit::test {

/// `seconds.nanoseconds` without a detour through a double.
inline Time parse_time(const std::string& text) {
  const auto dot = text.find('.');
  std::string fraction = dot == std::string::npos ? "" : text.substr(dot + 1);
  fraction.resize(9, '0');
  return Time(Duration(std::stoll(text.substr(0, dot)) * 1'000'000'000 + std::stoll(fraction)));
}

/// Lines of `t ax ay az gx gy gz`.
inline std::vector<ImuSample> read_imu_text(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<ImuSample> imu;
  std::string time;
  ImuSample s;
  while (file >> time >> s.accel_mps2.x() >> s.accel_mps2.y() >> s.accel_mps2.z() >> s.gyro_rps.x() >> s.gyro_rps.y() >>
         s.gyro_rps.z()) {
    s.time = parse_time(time);
    imu.push_back(s);
  }
  return imu;
}

/// Lines of `t x y z qx qy qz qw`.
inline Trajectory read_trajectory_text(const std::filesystem::path& path) {
  std::ifstream file(path);
  Trajectory trajectory;
  std::string time;
  Vector3d p;
  Eigen::Quaterniond q;
  while (file >> time >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> q.w())
    trajectory.push_back({parse_time(time), pose_from(rotation_from(q), p)});
  return trajectory;
}

}  // namespace pllit::test
