#include "pllit/io/point_time.hpp"

#include <array>
#include <cmath>
#include <format>
#include <limits>

namespace pllit {
namespace {

constexpr std::array kUnits = {TimeUnit::seconds, TimeUnit::milliseconds, TimeUnit::microseconds,
                               TimeUnit::nanoseconds};
constexpr double kShortestSweep_s = 0.02;
constexpr double kLongestSweep_s = 0.25;
constexpr double kLongestAccepted_s = 1.0;   // a slow scanner, or several sweeps in one message
constexpr double kFarthestRelative_s = 2.0;  // an offset counts from a stamp within its own sweep
constexpr double kFewestFloatSteps = 100.0;  // a sweep with fewer distinct float32 values has lost its point times
constexpr double kLargestHarmless = 1e3;     // below it, a constant float32 column is a filler, not a rounded epoch
constexpr double kEarliestDate_s = 1e9;      // 2001; offsets stay below it even in nanoseconds
constexpr double kLatestDate_s = 9.2e9;      // 2261, where 64 bits of nanoseconds end

constexpr std::int64_t nanoseconds_per(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::seconds:
      return 1'000'000'000;
    case TimeUnit::milliseconds:
      return 1'000'000;
    case TimeUnit::microseconds:
      return 1'000;
    case TimeUnit::nanoseconds:
      return 1;
  }
  return 1;
}

double seconds_per(TimeUnit unit) { return static_cast<double>(nanoseconds_per(unit)) * 1e-9; }

double largest_magnitude(const RawTimes& times) { return std::max(std::abs(times.min), std::abs(times.max)); }
double smallest_magnitude(const RawTimes& times) {
  return times.min <= 0.0 && times.max >= 0.0 ? 0.0 : std::min(std::abs(times.min), std::abs(times.max));
}

std::optional<TimeUnit> unit_that_puts(double value, double at_least_s, double at_most_s) {
  for (const TimeUnit unit : kUnits) {
    const double value_s = value * seconds_per(unit);
    if (value_s >= at_least_s && value_s <= at_most_s) return unit;
  }
  return std::nullopt;
}

/// The unit in which the times are of our days and the scan is not too long, if any: no offset looks like that.
std::optional<TimeUnit> unit_of_date(const RawTimes& times) {
  const auto unit = unit_that_puts(smallest_magnitude(times), kEarliestDate_s, kLatestDate_s);
  if (!unit || (times.max - times.min) * seconds_per(*unit) > kLongestAccepted_s) return std::nullopt;
  return unit;
}

std::unexpected<Error> absolute_in_float32(const RawTimes& times) {
  const float largest = static_cast<float>(largest_magnitude(times));
  const double step = std::nextafter(largest, std::numeric_limits<float>::infinity()) - largest;
  return input_error(std::format(
      "point time field '{}' holds absolute time in float32 (values near {:.9g}, which float32 resolves only in steps "
      "of {:.3g}), "
      "so the times of single points are lost. Record it as float64, or as an offset from the header stamp.",
      times.field, times.max, step));
}

bool float32_has_lost_it(const RawTimes& times) {
  if (!times.is_float32 || static_cast<double>(times.count) < kFewestFloatSteps) return false;
  const float largest = static_cast<float>(largest_magnitude(times));
  const double step = std::nextafter(largest, std::numeric_limits<float>::infinity()) - largest;
  return largest > kLargestHarmless && times.max - times.min < kFewestFloatSteps * step;
}

std::unexpected<Error> no_unit_fits(const RawTimes& times) {
  const double span = times.max - times.min;
  std::string spans;
  for (const TimeUnit unit : kUnits) {
    spans += std::format("{}{:.3g} s as {}", spans.empty() ? "" : ", ", span * seconds_per(unit), name_of(unit));
  }
  return input_error(
      std::format("point time field '{}' ({}) spans {:.6g} in one scan: {}. None is a sweep of {} to {} s; "
                  "set the unit with --set input.lidar_time_unit=s|ms|us|ns.",
                  times.field, times.datatype, span, spans, kShortestSweep_s, kLongestSweep_s));
}

}  // namespace

std::string_view name_of(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::seconds:
      return "s";
    case TimeUnit::milliseconds:
      return "ms";
    case TimeUnit::microseconds:
      return "us";
    case TimeUnit::nanoseconds:
      return "ns";
  }
  return "?";
}

std::optional<std::int64_t> to_nanoseconds(std::int64_t value, TimeUnit unit) {
  std::int64_t result = 0;
  if (__builtin_mul_overflow(value, nanoseconds_per(unit), &result)) return std::nullopt;
  return result;
}

std::optional<std::int64_t> to_nanoseconds(double value, TimeUnit unit) {
  if (!(std::abs(value) < 9.2e18)) return std::nullopt;  // also refuses NaN
  const double whole = std::floor(value);
  const auto whole_ns = to_nanoseconds(static_cast<std::int64_t>(whole), unit);
  const std::int64_t fraction_ns = std::llround((value - whole) * static_cast<double>(nanoseconds_per(unit)));
  std::int64_t result = 0;
  if (!whole_ns || __builtin_add_overflow(*whole_ns, fraction_ns, &result)) return std::nullopt;
  return result;
}

Expected<TimeLayout> find_time_layout(const RawTimes& times, std::optional<TimeUnit> given_unit) {
  if (float32_has_lost_it(times)) return absolute_in_float32(times);
  TimeLayout layout{.field = times.field, .datatype = times.datatype};
  const double span = times.max - times.min;
  std::optional<TimeUnit> unit = given_unit;
  if (!unit) unit = unit_of_date(times);
  if (!unit) unit = unit_that_puts(span, kShortestSweep_s, kLongestSweep_s);
  if (!unit) {
    unit = times.is_integer ? TimeUnit::nanoseconds : TimeUnit::seconds;
    layout.unit_is_certain = false;
  }
  if (!(span * seconds_per(*unit) <= kLongestAccepted_s)) return no_unit_fits(times);
  layout.unit = *unit;
  layout.absolute = smallest_magnitude(times) * seconds_per(*unit) > kFarthestRelative_s;
  if (layout.absolute && times.is_float32) return absolute_in_float32(times);
  return layout;
}

}  // namespace pllit
