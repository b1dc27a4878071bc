#include "support/bag_fixtures.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace pllit::test {
namespace {

constexpr std::array<std::uint8_t, 10> kDatatypeOfAlternative = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};

std::uint32_t size_of(const CloudNumber& number) {
  return std::visit([](auto value) { return static_cast<std::uint32_t>(sizeof(value)); }, number);
}

void write_number(ByteWriter& writer, const CloudNumber& number, bool big_endian) {
  std::visit(
      [&](auto value) {
        auto raw = std::bit_cast<std::array<std::byte, sizeof(value)>>(value);
        if (big_endian) std::ranges::reverse(raw);  // the tests run on little-endian machines
        writer.write_bytes(raw);
      },
      number);
}

void pad(ByteWriter& writer, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) writer.write(std::uint8_t{0xee});
}

void check(const Expected<void>& result) {
  if (!result) throw std::runtime_error(result.error().message);
}

LidarScan sample_scan(Time start) {
  LidarScan scan;
  scan.start = start;
  for (int i = 0; i < 50; ++i) {
    scan.points_L.emplace_back(1.0f + static_cast<float>(i), 2.0f, 3.0f);
    scan.offsets.emplace_back(std::chrono::milliseconds(2 * i));
    scan.intensity.push_back(static_cast<float>(i));
  }
  return scan;
}

}  // namespace

std::vector<std::byte> serialised(const CloudMessage& message) {
  const auto count = static_cast<std::uint32_t>(message.columns.front().values.size());
  const std::uint32_t width = count / message.height;
  ByteWriter writer;
  writer.write(std::uint32_t{7});
  writer.write(static_cast<std::uint32_t>(nanoseconds_of(message.stamp) / 1'000'000'000));
  writer.write(static_cast<std::uint32_t>(nanoseconds_of(message.stamp) % 1'000'000'000)).write_text("lidar");
  writer.write(message.height).write(width).write(static_cast<std::uint32_t>(message.columns.size()));
  std::uint32_t offset = 0;
  for (const CloudColumn& column : message.columns) {
    const CloudNumber& first = column.values.front();
    writer.write_text(column.name).write(offset);
    writer.write(column.datatype != 0 ? column.datatype : kDatatypeOfAlternative[first.index()]).write(column.elements);
    offset += size_of(first);
  }
  const std::uint32_t point_step = offset + message.point_padding;
  const std::uint32_t row_step = width * point_step + message.row_padding;
  writer.write(static_cast<std::uint8_t>(message.big_endian)).write(point_step).write(row_step);
  writer.write(message.height * row_step);
  for (std::uint32_t row = 0; row < message.height; ++row) {
    for (std::uint32_t i = row * width; i < (row + 1) * width; ++i) {
      for (const CloudColumn& column : message.columns) write_number(writer, column.values[i], message.big_endian);
      pad(writer, message.point_padding);
    }
    pad(writer, message.row_padding);
  }
  writer.write(static_cast<std::uint8_t>(message.is_dense));
  return writer.take();
}

std::vector<CloudColumn> points_on_a_line(std::size_t count) {
  std::vector<float> x, y(count, 2.0f), z(count, 3.0f);
  for (std::size_t i = 0; i < count; ++i) x.push_back(1.0f + static_cast<float>(i));
  return {column("x", x), column("y", y), column("z", z)};
}

std::vector<SensorEvent> sample_events(const SampleRecording& recording) {
  std::vector<SensorEvent> events;
  const Duration latency = std::chrono::milliseconds(5);
  const auto each = [&](Duration period, const auto& make) {
    for (Duration t{}; t < from_seconds(recording.duration_s); t += period) events.push_back(make(recording.start + t));
  };
  each(std::chrono::milliseconds(10),
       [&](Time time) { return SensorEvent{time + latency, ImuSample{time, {0.1, 0.2, 0.3}, {0.0, 0.0, 9.81}}}; });
  each(std::chrono::milliseconds(100), [&](Time time) {
    const LidarScan scan = sample_scan(time);
    return SensorEvent{scan.end() + latency, scan};
  });
  if (recording.with_images) {
    each(std::chrono::milliseconds(50), [&](Time time) {
      return SensorEvent{time + latency, CameraFrame{time, cv::Mat(6, 8, CV_16UC1, cv::Scalar(7000))}};
    });
  }
  std::ranges::stable_sort(events, {}, &SensorEvent::received);
  return events;
}

void write_bag(const std::filesystem::path& path, const std::vector<SensorEvent>& events, std::size_t chunk_bytes) {
  auto writer = BagWriter::create(path, chunk_bytes);
  if (!writer) throw std::runtime_error(writer.error().message);
  for (const auto& [received, data] : events) {
    if (const auto* imu = std::get_if<ImuSample>(&data)) check(writer->write_imu("/imu", received, *imu));
    if (const auto* scan = std::get_if<LidarScan>(&data)) check(writer->write_scan("/points", received, *scan));
    if (const auto* frame = std::get_if<CameraFrame>(&data)) {
      check(writer->write_image("/thermal/image", received, *frame));
    }
  }
  check(writer->close());
}

std::vector<char> contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_contents(const std::filesystem::path& path, const std::vector<char>& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace pllit::test
