#include "pllit/io/decoded_scan.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <limits>
#include <utility>

namespace pllit {
namespace {

constexpr Duration kLargestClockDifference = std::chrono::seconds(1);

LidarScan as_it_came(TimedPoints points, std::int64_t first_ns) {
  LidarScan scan;
  scan.offsets.reserve(points.times_ns.size());
  for (const std::int64_t time_ns : points.times_ns) scan.offsets.emplace_back(time_ns - first_ns);
  scan.points_L = std::move(points.points_L);
  scan.intensity = std::move(points.intensity);
  return scan;
}

}  // namespace

bool keep_point(const Eigen::Vector3f& point, DroppedPoints& dropped) {
  if (!point.allFinite()) {
    ++dropped.not_finite;
    return false;
  }
  if ((point.array() == 0.0f).all()) {
    ++dropped.zero;
    return false;
  }
  return true;
}

LidarScan sorted_scan(TimedPoints points) {
  const auto& times_ns = points.times_ns;
  if (times_ns.empty()) return {};
  const auto [first, last] = std::ranges::minmax(times_ns);
  assert(last - first <= std::numeric_limits<std::uint32_t>::max());
  if (std::ranges::is_sorted(times_ns)) return as_it_came(std::move(points), first);

  // One integer holds offset and place, so that sorting moves 8 bytes a point and ties keep their order.
  std::vector<std::uint64_t> order(times_ns.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint64_t>(times_ns[i] - first) << 32 | i;
  std::ranges::sort(order);
  LidarScan scan;
  scan.points_L.reserve(order.size());
  scan.offsets.reserve(order.size());
  scan.intensity.reserve(order.size());
  for (const std::uint64_t key : order) {
    const auto place = static_cast<std::uint32_t>(key);
    scan.points_L.push_back(points.points_L[place]);
    scan.offsets.emplace_back(static_cast<std::int64_t>(key >> 32));
    scan.intensity.push_back(points.intensity[place]);
  }
  return scan;
}

void set_start(DecodedScan& decoded, std::int64_t first_ns, Duration first_after_stamp) {
  const Time first{Duration(first_ns)};
  const bool header_is_set = decoded.header_stamp != Time{};
  // Compared in this order so that no difference of two arbitrary 64-bit times is formed.
  const bool near =
      first > decoded.header_stamp - kLargestClockDifference && first < decoded.header_stamp + kLargestClockDifference;
  decoded.clocks_differ = header_is_set && !near;
  decoded.scan.start = decoded.clocks_differ ? decoded.header_stamp + first_after_stamp : first;
}

}  // namespace pllit
