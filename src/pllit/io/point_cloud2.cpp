#include "pllit/io/point_cloud2.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <format>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pllit/io/point_fields.hpp"

namespace pllit {
namespace {

constexpr std::array<std::string_view, 9> kTimeNames = {"timestamp",   "time_stamp", "timestamps",
                                                        "time",        "t",          "offset_time",
                                                        "time_offset", "point_time", "timestamp_offset"};
constexpr std::array<std::string_view, 5> kIntensityNames = {"intensity", "reflectivity", "intensities", "reflectance",
                                                             "i"};

float float_at(Bytes point, const PointField& field, std::endian order) {
  float result = 0.0f;
  with_number(point, field, order, [&](auto number) { result = static_cast<float>(number); });
  return result;
}

struct Columns {
  PointField x, y, z;
  std::optional<PointField> intensity;
  std::optional<PointField> time;
};

std::optional<PointField> find_field(const std::vector<PointField>& fields, std::span<const std::string_view> names) {
  for (const std::string_view name : names) {
    const auto found = std::ranges::find(fields, name, &PointField::name);
    if (found != fields.end()) return *found;
  }
  return std::nullopt;
}

std::string listed(const std::vector<PointField>& fields) {
  std::string text;
  for (const PointField& field : fields) {
    text += std::format("{}{} ({})", text.empty() ? "" : ", ", field.name, facts_of(field.type).name);
  }
  return text.empty() ? "none" : text;
}

Expected<Columns> find_columns(const PointFieldCloud& cloud) {
  Columns columns;
  for (auto [field, name] : {std::pair{&columns.x, "x"}, std::pair{&columns.y, "y"}, std::pair{&columns.z, "z"}}) {
    const auto found = std::ranges::find(cloud.fields, name, &PointField::name);
    if (found == cloud.fields.end()) {
      return input_error(std::format("PointCloud2 has no field '{}'; its fields are: {}", name, listed(cloud.fields)));
    }
    *field = *found;
  }
  columns.intensity = find_field(cloud.fields, kIntensityNames);
  columns.time = find_field(cloud.fields, kTimeNames);
  for (const std::optional<PointField>& field : {std::optional(columns.x), std::optional(columns.y),
                                                 std::optional(columns.z), columns.intensity, columns.time}) {
    if (field && field->offset + facts_of(field->type).size_bytes > cloud.point_step) {
      return input_error(std::format("PointCloud2 field '{}' at byte {} lies outside the point of {} bytes",
                                     field->name, field->offset, cloud.point_step));
    }
  }
  return columns;
}

/// Point times in the very type they were recorded in (integers as int64, floats as double, both exact).
using RawTimeColumn = std::variant<std::vector<double>, std::vector<std::int64_t>>;

struct RawScan {
  TimedPoints points;  ///< times_ns not yet filled
  RawTimeColumn times;
  DroppedPoints dropped;
};

bool append_time(Bytes point, const PointField& field, std::endian order, RawTimeColumn& times) {
  bool valid = true;
  with_number(point, field, order, [&]<class T>(T number) {
    if constexpr (std::floating_point<T>) {
      valid = std::isfinite(number);
      if (valid) std::get<0>(times).push_back(static_cast<double>(number));
    } else {
      valid = std::in_range<std::int64_t>(number);
      if (valid) std::get<1>(times).push_back(static_cast<std::int64_t>(number));
    }
  });
  return valid;
}

bool is_integer(Datatype type) { return type != Datatype::float32 && type != Datatype::float64; }

RawScan read_points(const PointFieldCloud& cloud, const Columns& columns) {
  RawScan raw;
  if (columns.time && is_integer(columns.time->type)) raw.times = std::vector<std::int64_t>{};
  raw.points.points_L.reserve(cloud.height * cloud.width);
  raw.points.intensity.reserve(cloud.height * cloud.width);
  for (std::size_t row = 0; row < cloud.height; ++row) {
    for (std::size_t column = 0; column < cloud.width; ++column) {
      const Bytes bytes = cloud.point(row, column);
      const Eigen::Vector3f point_L(float_at(bytes, columns.x, cloud.order), float_at(bytes, columns.y, cloud.order),
                                    float_at(bytes, columns.z, cloud.order));
      if (!keep_point(point_L, raw.dropped)) continue;
      if (columns.time && !append_time(bytes, *columns.time, cloud.order, raw.times)) {
        ++raw.dropped.bad_time;
        continue;
      }
      raw.points.points_L.push_back(point_L);
      raw.points.intensity.push_back(columns.intensity ? float_at(bytes, *columns.intensity, cloud.order) : 0.0f);
    }
  }
  return raw;
}

RawTimes describe(const PointField& field, const RawTimeColumn& column) {
  RawTimes times{.field = field.name,
                 .datatype = std::string(facts_of(field.type).name),
                 .is_float32 = field.type == Datatype::float32,
                 .is_integer = is_integer(field.type)};
  std::visit(
      [&](const auto& values) {
        const auto [min, max] = std::ranges::minmax(values);
        times.count = values.size();
        times.min = static_cast<double>(min);
        times.max = static_cast<double>(max);
      },
      column);
  return times;
}

Expected<std::vector<std::int64_t>> in_nanoseconds(const RawTimeColumn& column, const TimeLayout& layout) {
  std::vector<std::int64_t> times_ns;
  const auto convert = [&](const auto& values) -> Expected<void> {
    times_ns.reserve(values.size());
    for (const auto value : values) {
      const auto time_ns = to_nanoseconds(value, layout.unit);
      if (!time_ns) return input_error(std::format("point time {} {} is beyond 64 bits", value, name_of(layout.unit)));
      times_ns.push_back(*time_ns);
    }
    return {};
  };
  if (auto converted = std::visit(convert, column); !converted) return std::unexpected(converted.error());
  return times_ns;
}

/// Time of the first point where offsets count from the header stamp.
Time relative_start(const DecodedScan& decoded, std::int64_t first_ns, bool stamp_at_scan_end) {
  const Duration first(first_ns);
  const Duration sweep = decoded.scan.offsets.back();
  // Offsets that are mostly below zero already count from the end of the sweep.
  const Duration last = first + sweep;
  const bool shift = stamp_at_scan_end && last > sweep / 2;
  return decoded.header_stamp + first - (shift ? last : Duration{});
}

}  // namespace

Expected<DecodedScan> decode_point_cloud2(Bytes message, const PointCloudOptions& options) {
  const Expected<PointFieldCloud> cloud = read_point_fields(message);
  if (!cloud) return std::unexpected(cloud.error());
  const Expected<Columns> columns = find_columns(*cloud);
  if (!columns) return std::unexpected(columns.error());

  RawScan raw = read_points(*cloud, *columns);
  const std::size_t count = raw.points.points_L.size();
  DecodedScan decoded{.header_stamp = cloud->header.stamp, .dropped = raw.dropped};
  decoded.scan.start = decoded.header_stamp;
  if (count == 0) return decoded;
  if (!columns->time) {
    raw.points.times_ns.assign(count, 0);
    decoded.scan = sorted_scan(std::move(raw.points));
    decoded.scan.start = decoded.header_stamp;
    return decoded;
  }

  const RawTimes times = describe(*columns->time, raw.times);
  const Expected<TimeLayout> layout = find_time_layout(times, options.time_unit);
  if (!layout) return std::unexpected(layout.error());
  auto times_ns = in_nanoseconds(raw.times, *layout);
  if (!times_ns) return std::unexpected(times_ns.error());
  raw.points.times_ns = std::move(*times_ns);
  const std::int64_t first_ns = std::ranges::min(raw.points.times_ns);
  decoded.time_layout = *layout;
  decoded.has_time = count == 1 || times.max > times.min;
  decoded.scan = sorted_scan(std::move(raw.points));
  if (layout->absolute) {
    set_start(decoded, first_ns);
  } else {
    decoded.scan.start = relative_start(decoded, first_ns, options.stamp_at_scan_end);
  }
  return decoded;
}

}  // namespace pllit
