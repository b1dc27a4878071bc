// Which topics of a recording carry the LiDAR, the IMU and the camera.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/base/time.hpp"

namespace pllit {

/// One topic of one bag.
struct TopicInfo {
  std::string name{};
  std::string type{};  ///< e.g. "sensor_msgs/Imu"
  std::uint64_t count = 0;
  Time first{};  ///< received, first and last message
  Time last{};
  std::filesystem::path bag{};

  /// Mean rate, zero where it cannot be told.
  double rate_hz() const {
    const double duration_s = to_seconds(last - first);
    return count > 1 && duration_s > 0.0 ? static_cast<double>(count - 1) / duration_s : 0.0;
  }
};

enum class SensorRole { imu, lidar, image };

/// True for message types that can be decoded for the role.
bool serves(SensorRole role, std::string_view type);

/// The topic of a role: `wanted`, or where that is empty the only one of a fitting type. Nothing where no image is
/// there (a recording needs none). Errors: none or several are there, or `wanted` is missing or of another type; they
/// list what is there, what is likely meant, and the option that says so.
Expected<std::optional<std::string>> choose_topic(SensorRole role, const std::string& wanted,
                                                  const std::vector<TopicInfo>& topics);

}  // namespace pllit
