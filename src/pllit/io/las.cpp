#include "pllit/io/las.hpp"

#include <cmath>
#include <cstdint>
#include <format>
#include <limits>

#include "pllit/io/file.hpp"
#include "pllit/io/point_records.hpp"

namespace pllit {
namespace {

// LAS 1.4 R15, sections 2.4 (header), 2.5 (variable length records), 2.6.2 (point format 0), table 24 (extra bytes).
constexpr std::uint16_t kHeaderBytes = 375, kRecordHeaderBytes = 54, kExtraFieldBytes = 192, kPointBytes = 20;
constexpr std::uint16_t kExtraBytesRecord = 4;
constexpr std::uint8_t kFloatType = 9;
constexpr std::uint8_t kOnlyReturn = 1 | (1 << 3);  // return 1 of 1
constexpr std::size_t kMostFields = std::numeric_limits<std::uint16_t>::max() / kExtraFieldBytes;
constexpr std::size_t kMostPoints = std::numeric_limits<std::uint32_t>::max();

using Vector3i = Eigen::Matrix<std::int32_t, 3, 1>;

/// Coordinates are stored as integers: metres = scale * integer + offset.
struct Grid {
  double scale_m = 1e-4;
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();

  Vector3i integers(const Eigen::Vector3f& point) const {
    return ((point.cast<double>() - offset_m) / scale_m).array().round().cast<std::int32_t>();
  }
  Eigen::Vector3d metres(const Vector3i& integers) const { return scale_m * integers.cast<double>() + offset_m; }
};

struct Bounds {
  Eigen::Vector3f low = Eigen::Vector3f::Zero(), high = Eigen::Vector3f::Zero();
};

Bounds bounds_of(const PointTable& table) {
  if (table.points.empty()) return {};
  Bounds bounds{table.points.front(), table.points.front()};
  for (const auto& point : table.points) {
    bounds.low = bounds.low.cwiseMin(point);
    bounds.high = bounds.high.cwiseMax(point);
  }
  return bounds;
}

Grid grid_for(const Bounds& bounds) {
  Grid grid;
  const Eigen::Vector3d low = bounds.low.cast<double>(), high = bounds.high.cast<double>();
  grid.offset_m = (0.5 * (low + high)).array().round();
  const double reach_m = (high - low).maxCoeff() / 2.0 + 1.0;  // the offset is rounded to a metre
  while (reach_m / grid.scale_m > 2e9) grid.scale_m *= 10.0;
  return grid;
}

std::string padded(std::string_view text, std::size_t size) {
  std::string bytes(text);
  bytes.resize(size, '\0');
  return bytes;
}

void append_bounds(std::string& bytes, const Grid& grid, const Bounds& bounds) {
  const Eigen::Vector3d high = grid.metres(grid.integers(bounds.high)), low = grid.metres(grid.integers(bounds.low));
  for (int axis = 0; axis < 3; ++axis) {
    append_bytes(bytes, high[axis]);
    append_bytes(bytes, low[axis]);
  }
}

std::string header_of(const PointTable& table, const Grid& grid, const Bounds& bounds) {
  const std::size_t fields = table.fields.size(), points = table.points.size();
  const std::size_t record_bytes = fields == 0 ? 0 : kRecordHeaderBytes + fields * kExtraFieldBytes;
  std::string h = "LASF";
  h += std::string(4 + 16, '\0');  // source, encoding, project
  append_bytes<std::uint8_t>(h, 1);
  append_bytes<std::uint8_t>(h, 4);
  h += padded("PL-LIT", 32) + padded("PL-LIT", 32);
  h += std::string(4, '\0');  // creation day and year
  append_bytes(h, kHeaderBytes);
  append_bytes(h, static_cast<std::uint32_t>(kHeaderBytes + record_bytes));
  append_bytes<std::uint32_t>(h, fields == 0 ? 0 : 1);
  append_bytes<std::uint8_t>(h, 0);  // point format
  append_bytes(h, static_cast<std::uint16_t>(kPointBytes + fields * sizeof(float)));
  append_bytes(h, static_cast<std::uint32_t>(points));
  append_bytes(h, static_cast<std::uint32_t>(points));  // first returns
  h += std::string(4 * sizeof(std::uint32_t), '\0');    // further returns
  for (int axis = 0; axis < 3; ++axis) append_bytes(h, grid.scale_m);
  for (const double offset : grid.offset_m) append_bytes(h, offset);
  append_bounds(h, grid, bounds);
  h += std::string(8 + 8 + 4, '\0');  // waveforms, extended records
  append_bytes(h, static_cast<std::uint64_t>(points));
  append_bytes(h, static_cast<std::uint64_t>(points));
  return padded(h, kHeaderBytes);
}

/// The variable length record that names the floats behind each point.
std::string extra_bytes_record(const PointTable& table) {
  if (table.fields.empty()) return {};
  std::string record(2, '\0');
  record += padded("LASF_Spec", 16);
  append_bytes(record, kExtraBytesRecord);
  append_bytes(record, static_cast<std::uint16_t>(table.fields.size() * kExtraFieldBytes));
  record += padded("scalar fields", 32);
  for (const ScalarField& field : table.fields) {
    std::string entry(2, '\0');
    append_bytes(entry, kFloatType);
    append_bytes<std::uint8_t>(entry, 0);  // neither scaled nor bounded
    entry += padded(field.name, 32);
    record += padded(entry, kExtraFieldBytes);
  }
  return record;
}

std::string point_rows(const PointTable& table, const Grid& grid, std::size_t begin, std::size_t end) {
  std::string rows;
  for (std::size_t i = begin; i < end; ++i) {
    for (const std::int32_t coordinate : grid.integers(table.points[i])) append_bytes(rows, coordinate);
    rows += std::string(2, '\0');  // intensity
    append_bytes(rows, kOnlyReturn);
    rows += std::string(5, '\0');  // class, angle, user data, source
    for (const ScalarField& field : table.fields) append_bytes(rows, field.values[i]);
  }
  return rows;
}

}  // namespace

Expected<void> write_las(const std::filesystem::path& path, const PointTable& table) {
  const auto checked = check_field_names(field_names(table)).and_then([&] { return check_points(table); });
  if (!checked) return in_context(path.string(), checked.error());
  if (table.fields.size() > kMostFields || table.points.size() > kMostPoints)
    return failure(std::format("{}: {} fields of {} points are more than LAS holds", path.string(), table.fields.size(),
                               table.points.size()));
  const Bounds bounds = bounds_of(table);
  const Grid grid = grid_for(bounds);
  auto file = OutputFile::create(path);
  if (!file) return std::unexpected(file.error());
  if (auto head = file->write(header_of(table, grid, bounds) + extra_bytes_record(table)); !head) return head;
  constexpr std::size_t chunk = 1 << 15;
  for (std::size_t begin = 0; begin < table.points.size(); begin += chunk)
    if (auto rows = file->write(point_rows(table, grid, begin, std::min(begin + chunk, table.points.size()))); !rows)
      return rows;
  return file->close();
}

}  // namespace pllit
