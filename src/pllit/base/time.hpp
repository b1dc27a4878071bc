// Time of the sensor clock as integer nanoseconds; never wall clock, never seconds in a double.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

namespace pllit {

using Duration = std::chrono::nanoseconds;
using Time = std::chrono::sys_time<Duration>;

/// Seconds as a double: for intervals, where nanoseconds survive; absolute times lose precision.
constexpr double to_seconds(Duration duration) { return static_cast<double>(duration.count()) * 1e-9; }
constexpr double to_seconds(Time time) { return to_seconds(time.time_since_epoch()); }

inline Duration from_seconds(double seconds) { return Duration(std::llround(seconds * 1e9)); }

/// ROS 1 time stamp: whole seconds and nanoseconds since the epoch.
constexpr Time time_from_parts(std::uint32_t seconds, std::uint32_t nanoseconds) {
  return Time(Duration(static_cast<std::int64_t>(seconds) * 1'000'000'000 + nanoseconds));
}

constexpr std::int64_t nanoseconds_of(Time time) { return time.time_since_epoch().count(); }

}  // namespace pllit
