// What a user may set. Each module's own struct is nested here; config_keys.cpp lists which members are keys of the
// YAML file.
#pragma once

#include <array>
#include <string>

#include "pllit/lidar/degeneracy.hpp"
#include "pllit/lidar/downsample.hpp"
#include "pllit/lidar/plane_map.hpp"
#include "pllit/lidar/plane_residuals.hpp"
#include "pllit/loop/loop_config.hpp"
#include "pllit/sensor/rig.hpp"
#include "pllit/slam/drift.hpp"
#include "pllit/slam/health.hpp"
#include "pllit/slam/thermography_config.hpp"
#include "pllit/slam/vision_config.hpp"
#include "pllit/state/iterated_update.hpp"
#include "pllit/state/propagation.hpp"
#include "pllit/state/start_up.hpp"

namespace pllit {

/// Unit of the per-point times of a cloud; automatic: from the span of one scan.
enum class PointTimeUnit { automatic, s, ms, us, ns };

struct InputConfig {
  std::string imu_topic;    ///< empty: the only topic of that type
  std::string lidar_topic;  ///< likewise
  std::string image_topic;  ///< likewise
  PointTimeUnit lidar_time_unit = PointTimeUnit::automatic;
};

/// A pose T_A_B as numbers: p_A = R p_B + t. The quaternion has unit length to within rounding.
struct PoseConfig {
  std::array<double, 3> translation_m{0.0, 0.0, 0.0};
  std::array<double, 4> rotation_xyzw{0.0, 0.0, 0.0, 1.0};
};

/// The rig in the units of data sheets and calibration files; make_rig turns it into what the estimator uses.
struct RigConfig {
  struct Imu {
    std::array<double, 2> noise_density{ImuNoise{}.gyro_density,
                                        ImuNoise{}.accel_density};  ///< rad/s, m/s2 per sqrt(Hz)
    std::array<double, 2> bias_walk{ImuNoise{}.gyro_bias_walk,
                                    ImuNoise{}.accel_bias_walk};  ///< rad/s2, m/s3 per sqrt(Hz)
    std::array<double, 2> bias_sigma{ImuNoise{}.gyro_bias_sigma, ImuNoise{}.accel_bias_sigma};  ///< rad/s, m/s2
  } imu;
  struct Lidar {
    PoseConfig T_I_L;
    double delay_s = 0.0;  ///< added to the LiDAR's stamps to get IMU time
    std::array<double, 2> range_m{LidarModel{}.min_range_m, LidarModel{}.max_range_m};
    double range_sigma_m = LidarModel{}.range_sigma_m;
    double beam_sigma_deg = 0.06;
  } lidar;
  struct Camera {
    PoseConfig T_I_C;
    double delay_s = 0.0;                                     ///< added to the camera's stamps to get IMU time
    std::array<int, 2> size_px{0, 0};                         ///< width, height; zeros: no calibrated camera
    std::array<double, 4> intrinsics_px{0.0, 0.0, 0.0, 0.0};  ///< fx, fy, cx, cy
    pllit::Camera::Distortion model = pllit::Camera::Distortion::radtan;
    std::array<double, 5> distortion{0.0, 0.0, 0.0, 0.0, 0.0};  ///< as in pllit::Camera::k
  } camera;
};

/// How a session is told as a page.
struct ReportConfig {
  std::string severity;  ///< file with a table of severity; empty: the built-in one
};

/// The whole configuration of a run.
struct Config {
  InputConfig input;
  RigConfig rig;
  StartUpConfig start;
  PlaneMapConfig map;
  double map_file_voxel_m = 0.1;  ///< the written map holds one point in each voxel of this size
  int threads = 0;                ///< 0: one for every core
  ScanConfig scan;
  PlaneResidualConfig planes;
  DegeneracyConfig degeneracy;
  FilterConfig filter;
  GapModel gaps;
  DriftConfig drift;
  HealthConfig health;
  VisionConfig vision;
  ThermographyConfig thermography = open_thresholds();
  LoopConfig loop;
  ReportConfig report;
};

/// Equal in every key.
bool operator==(const Config& a, const Config& b);

/// Checks what no single key can show: a range that is empty, a camera of which half is missing.
Expected<void> check(const Config& config);

/// The rig in SI units, quaternions normalised. Expects a configuration that passed `check`; `camera` stays empty where
/// size_px is zero.
Rig make_rig(const RigConfig& config);

}  // namespace pllit
