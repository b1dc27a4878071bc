// Time spent in each stage of a frame.
#pragma once

#include <array>
#include <chrono>
#include <string_view>

namespace pllit {

enum class Stage { read, propagate, deskew, lidar, photometric, features, track, thermal, map, loop };
inline constexpr std::array<std::string_view, 10> stage_names{
    "read", "propagate", "deskew", "lidar", "photometric", "features", "track", "thermal", "map", "loop"};
using StageTimes = std::array<double, stage_names.size()>;  ///< ms

/// Charges the time since the last call to a stage.
class StageClock {
 public:
  void charge(Stage stage) {
    const auto now = Clock::now();
    times_[static_cast<std::size_t>(stage)] += std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
  }
  const StageTimes& times_ms() const { return times_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
  StageTimes times_{};
};

}  // namespace pllit
