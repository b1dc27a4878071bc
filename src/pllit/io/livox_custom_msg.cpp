#include "pllit/io/livox_custom_msg.hpp"

#include <algorithm>
#include <format>
#include <limits>
#include <utility>

#include "pllit/io/ros_messages.hpp"

namespace pllit {
namespace {

constexpr std::size_t kLivoxPointBytes = 19;
constexpr std::int64_t kLongestScan_ns = 1'000'000'000;

struct CustomPoint {
  std::uint32_t offset_ns = 0;
  Eigen::Vector3f point_L;
  std::uint8_t reflectivity = 0;
  std::uint8_t tag = 0;
};

CustomPoint read_point(ByteReader& reader) {
  CustomPoint point;
  point.offset_ns = reader.read<std::uint32_t>();
  for (int axis = 0; axis < 3; ++axis) point.point_L[axis] = reader.read<float>();
  point.reflectivity = reader.read<std::uint8_t>();
  point.tag = reader.read<std::uint8_t>();
  reader.skip(1);  // laser line
  return point;
}

/// Tag byte: bits 5-4 the return number, bits 3-2 noise by intensity, bits 1-0 noise by position; 01 is certain noise.
bool is_noise(std::uint8_t tag) {
  const int return_number = tag >> 4 & 3;
  const int by_intensity = tag >> 2 & 3;
  const int by_position = tag & 3;
  return return_number > 1 || by_intensity == 1 || by_position == 1;
}

TimedPoints read_points(ByteReader& reader, std::size_t count, DroppedPoints& dropped) {
  TimedPoints points;
  points.points_L.reserve(count);
  points.times_ns.reserve(count);
  points.intensity.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const CustomPoint point = read_point(reader);
    if (!keep_point(point.point_L, dropped)) continue;
    if (is_noise(point.tag)) {
      ++dropped.noise;
      continue;
    }
    points.points_L.push_back(point.point_L);
    points.times_ns.push_back(point.offset_ns);
    points.intensity.push_back(point.reflectivity);
  }
  return points;
}

}  // namespace

Expected<DecodedScan> decode_livox_custom_msg(Bytes message) {
  ByteReader reader(message);
  DecodedScan decoded{.header_stamp = read_header(reader).stamp};
  decoded.time_layout =
      TimeLayout{.field = "offset_time", .datatype = "uint32", .unit = TimeUnit::nanoseconds, .absolute = true};
  const auto timebase_ns = reader.read<std::uint64_t>();
  const auto point_num = reader.read<std::uint32_t>();
  reader.skip(4);  // lidar_id and 3 reserved bytes
  const std::size_t count = reader.read<std::uint32_t>();
  if (!reader.ok() || count != point_num || reader.remaining() != count * kLivoxPointBytes) {
    return input_error(
        std::format("Livox CustomMsg of {} bytes is cut short or laid out differently (it announces {} and "
                    "{} points of {} bytes, {} bytes are there)",
                    message.size(), point_num, count, kLivoxPointBytes, reader.remaining()));
  }
  TimedPoints points = read_points(reader, count, decoded.dropped);
  decoded.scan.start = decoded.header_stamp;
  if (points.times_ns.empty()) return decoded;
  const auto [first_ns, last_ns] = std::ranges::minmax(points.times_ns);
  if (last_ns - first_ns > kLongestScan_ns) {
    return input_error(
        std::format("Livox CustomMsg spans {:.3f} s; its times are damaged", to_seconds(Duration(last_ns - first_ns))));
  }
  decoded.has_time = count == 1 || last_ns > first_ns;
  decoded.scan = sorted_scan(std::move(points));
  // A timebase beyond int64 is no time at all; zero stands for it and is as far from any header stamp.
  const bool representable =
      timebase_ns < static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max() - last_ns);
  set_start(decoded, (representable ? static_cast<std::int64_t>(timebase_ns) : 0) + first_ns, Duration(first_ns));
  return decoded;
}

}  // namespace pllit
