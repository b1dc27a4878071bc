// Per-point time of a cloud: which unit it is in, whether it is absolute, and its value in integer nanoseconds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "pllit/base/error.hpp"
#include "pllit/base/time.hpp"

namespace pllit {

enum class TimeUnit { seconds, milliseconds, microseconds, nanoseconds };

/// "s", "ms", "us" or "ns".
std::string_view name_of(TimeUnit unit);

/// `value` units in nanoseconds, exact to half a nanosecond of what the double holds (whole and fractional units are
/// converted apart). Nothing where it is not finite or beyond 64 bits.
std::optional<std::int64_t> to_nanoseconds(double value, TimeUnit unit);
std::optional<std::int64_t> to_nanoseconds(std::int64_t value, TimeUnit unit);

/// What is known of a scan's raw time column before it is converted.
struct RawTimes {
  std::string field;
  std::string datatype;     ///< as in sensor_msgs/PointField, e.g. "float32"
  bool is_float32 = false;  ///< then absolute time cannot be held
  bool is_integer = false;  ///< then nanoseconds are the convention, otherwise seconds
  std::size_t count = 0;    ///< points in the column
  double min = 0.0;         ///< in raw units; good enough to choose a unit, never used as a time
  double max = 0.0;
};

/// How a cloud carries time.
struct TimeLayout {
  std::string field;
  std::string datatype;
  TimeUnit unit = TimeUnit::seconds;
  bool absolute = false;        ///< stamps count from the clock's epoch, otherwise from the header stamp
  bool unit_is_certain = true;  ///< the span of this scan singles the unit out, or it was given
};

/// Finds unit and reference from the span of one sweep (0.02 to 0.25 s) and the magnitude, unless the unit is given.
/// Where the sweep is too short to tell, today's date singles out the unit of absolute times, and for offsets the
/// convention of the datatype holds (integers ns, floats s). Errors: absolute time in float32 (which resolves 128 s at
/// today's date), and spans that fit no unit.
Expected<TimeLayout> find_time_layout(const RawTimes& times, std::optional<TimeUnit> given_unit);

}  // namespace pllit
