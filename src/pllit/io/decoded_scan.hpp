// What a decoded LiDAR message gives: a valid LidarScan, and how it was read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pllit/io/point_time.hpp"
#include "pllit/sensor/measurements.hpp"

namespace pllit {

/// Points that a message held and the scan does not.
struct DroppedPoints {
  std::size_t not_finite = 0;
  std::size_t zero = 0;      ///< missing returns, recorded as (0, 0, 0)
  std::size_t bad_time = 0;  ///< time not finite or beyond 64 bits of nanoseconds
  std::size_t noise = 0;     ///< tagged so by the sensor
};

struct DecodedScan {
  LidarScan scan{};
  Time header_stamp{};
  DroppedPoints dropped{};
  std::optional<TimeLayout> time_layout{};  ///< nothing where the message has no time field
  bool has_time = false;                    ///< false: the points carry no usable time and all offsets are zero
  bool clocks_differ =
      false;  ///< absolute point times lie over 1 s from the header stamp, so start is the header stamp
};

/// Points of one message in its order, each with a time in nanoseconds from any one moment. Equal lengths.
struct TimedPoints {
  std::vector<Eigen::Vector3f> points_L;
  std::vector<std::int64_t> times_ns;
  std::vector<float> intensity;
};

/// True for a finite point other than (0, 0, 0); otherwise counts it.
bool keep_point(const Eigen::Vector3f& point, DroppedPoints& dropped);

/// Sorts by time (equal times keep their order); offsets count from the first point, `start` is left at zero.
/// Times must span less than 4 s.
LidarScan sorted_scan(TimedPoints points);

/// Sets start from the absolute time of the first point, or where that lies over a second from the header stamp from
/// the latter plus `first_after_stamp`: then the LiDAR's clock was not synchronised, and only the header stamp can be
/// compared with other sensors.
void set_start(DecodedScan& decoded, std::int64_t first_ns, Duration first_after_stamp = Duration{});

}  // namespace pllit
