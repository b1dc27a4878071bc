// Keyframes of a run with the true poses at their times, kept in a file so that loop closing alone can be run again.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "pllit/loop/keyframe.hpp"
#include "pllit/state/trajectory.hpp"

namespace pllit::bench {

struct KeyframeRun {
  std::vector<LoopKeyframe> keyframes;
  Trajectory truth;  ///< at their times
  double odometry_ms = 0.0, duration_s = 0.0;
};

/// As they lie in memory: for the machine and build that wrote them.
inline void write_keyframes(const std::filesystem::path& path, const KeyframeRun& run) {
  std::ofstream file(path, std::ios::binary);
  const auto put = [&](const void* data, std::size_t size) {
    file.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  };
  const std::size_t count = run.keyframes.size();
  put(&count, sizeof count);
  put(&run.odometry_ms, sizeof run.odometry_ms);
  put(&run.duration_s, sizeof run.duration_s);
  for (std::size_t k = 0; k < count; ++k) {
    const LoopKeyframe& keyframe = run.keyframes[k];
    put(&keyframe.time, sizeof keyframe.time);
    put(keyframe.T_O_I.coeffs().data(), 7 * sizeof(double));
    put(run.truth[k].T_W_I.coeffs().data(), 7 * sizeof(double));
    put(keyframe.step_covariance.data(), 36 * sizeof(double));
    put(keyframe.up_I.data(), 3 * sizeof(double));
    put(&keyframe.up_sigma_rad, sizeof(double));
    put(&keyframe.way_m, sizeof(double));
    const std::vector<Vector3f> points = keyframe.cloud.points();
    const std::size_t size = points.size();
    put(&size, sizeof size);
    put(points.data(), size * sizeof(Vector3f));
  }
}

inline KeyframeRun read_keyframes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const auto get = [&](void* data, std::size_t size) {
    file.read(static_cast<char*>(data), static_cast<std::streamsize>(size));
  };
  const auto pose = [&] {
    Eigen::Matrix<double, 7, 1> coefficients;
    get(coefficients.data(), 7 * sizeof(double));
    return SE3(coefficients);
  };
  KeyframeRun run;
  std::size_t count = 0;
  get(&count, sizeof count);
  get(&run.odometry_ms, sizeof run.odometry_ms);
  get(&run.duration_s, sizeof run.duration_s);
  for (std::size_t k = 0; k < count; ++k) {
    LoopKeyframe keyframe;
    get(&keyframe.time, sizeof keyframe.time);
    keyframe.T_O_I = pose();
    run.truth.push_back({keyframe.time, pose()});
    get(keyframe.step_covariance.data(), 36 * sizeof(double));
    get(keyframe.up_I.data(), 3 * sizeof(double));
    get(&keyframe.up_sigma_rad, sizeof(double));
    get(&keyframe.way_m, sizeof(double));
    std::size_t size = 0;
    get(&size, sizeof size);
    std::vector<Vector3f> points(size);
    get(points.data(), size * sizeof(Vector3f));
    keyframe.cloud = CompactCloud(points);
    run.keyframes.push_back(std::move(keyframe));
  }
  return run;
}

}  // namespace pllit::bench
