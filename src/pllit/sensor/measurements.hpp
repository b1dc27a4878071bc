// What sensors deliver: plain values, one invariant each.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/base/time.hpp"

namespace pllit {

/// Angular rate and specific force in I, biased; at rest the accelerometer shows +g upwards. The accelerometer's unit
/// is as recorded (m/s2 or g) until start-up has decided it.
struct ImuSample {
  Time time;
  Eigen::Vector3d gyro_rps = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_mps2 = Eigen::Vector3d::Zero();
};

/// One sweep in the LiDAR frame, metres, finite and non-zero points only. The three vectors have equal length; offsets
/// ascend and count from start.
struct LidarScan {
  Time start;
  std::vector<Eigen::Vector3f> points_L;
  std::vector<Duration> offsets;
  std::vector<float> intensity;
  std::vector<std::uint16_t> rings{};  ///< laser of each point; empty where unknown

  Time end() const { return offsets.empty() ? start : start + offsets.back(); }
};

/// One image with its counts as they came: CV_8UC1, CV_8UC3 (BGR) or CV_16UC1.
struct CameraFrame {
  Time time;  ///< stamp as recorded; delays are the rig's business
  cv::Mat counts;
};

/// A measurement with the time at which the recorder received it (its clock may differ from the sensor's).
struct SensorEvent {
  Time received;
  std::variant<ImuSample, LidarScan, CameraFrame> data;
};

/// Anything that delivers events in the order received: a recording, a simulator.
class EventSource {
 public:
  virtual ~EventSource() = default;
  /// The next event; nothing at the end; an error ends the source, and what came before it stands.
  virtual Expected<std::optional<SensorEvent>> next() = 0;
  /// Share of the source already delivered, 0 to 1; negative where unknown.
  virtual double progress() const { return -1.0; }
  /// What was noticed and survived so far (dropped points, skipped messages), in words.
  virtual std::vector<std::string> notes() const { return {}; }
};

}  // namespace pllit
