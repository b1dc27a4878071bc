// Recordings that nobody here made, against decodes that share nothing with the reader.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pllit/io/bag_description.hpp"
#include "pllit/io/bag_reader.hpp"
#include "pllit/io/point_cloud2.hpp"
#include "support/recordings.hpp"
#include "support/rosbag_bytes.hpp"

namespace pllit {
namespace {

template <class T>
T raw(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

std::vector<std::uint8_t> first_message(const std::filesystem::path& path, const std::string& type) {
  rosbag::Bag bag(path.string());
  rosbag::View view(bag, rosbag::TypeQuery(type));
  return view.size() == 0 ? std::vector<std::uint8_t>{} : test::bytes_of(*view.begin());
}

TEST(RecordingReading, ReadsARealHesaiScanToTheMicrosecond) {
  PLLIT_RECORDING(path, "hilti_scan/hilti_scan.bag");
  const auto bytes = first_message(path, "sensor_msgs/PointCloud2");
  const auto decoded = decode_point_cloud2(std::as_bytes(std::span(bytes)));
  ASSERT_TRUE(decoded) << decoded.error().message;

  // The message ends with is_dense; its data holds points of 48 bytes: x, y, z at 0, 4, 8, timestamp at 24.
  constexpr std::size_t kStep = 48;
  constexpr std::size_t kData = 155;  // behind the header, six fields and the sizes
  const std::size_t count = raw<std::uint32_t>(bytes.data() + kData - 4) / kStep;
  ASSERT_EQ(kData + count * kStep + 1, bytes.size());
  std::vector<std::pair<double, Eigen::Vector3f>> truth;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* point = bytes.data() + kData + i * kStep;
    const Eigen::Vector3f position(raw<float>(point), raw<float>(point + 4), raw<float>(point + 8));
    if (position.allFinite() && !position.isZero(0.0f)) truth.emplace_back(raw<double>(point + 24), position);
  }
  std::ranges::stable_sort(truth, {}, &std::pair<double, Eigen::Vector3f>::first);

  const LidarScan& scan = decoded->scan;
  ASSERT_EQ(scan.points_L.size(), truth.size());
  EXPECT_GT(truth.size(), 20'000u);
  EXPECT_TRUE(decoded->time_layout->absolute);
  EXPECT_EQ(decoded->time_layout->field, "timestamp");
  EXPECT_NEAR(to_seconds(scan.offsets.back()), 0.1, 0.01);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto time_ns = nanoseconds_of(scan.start + scan.offsets[i]);
    EXPECT_LE(std::abs(time_ns - std::llround(static_cast<long double>(truth[i].first) * 1e9L)), 1);
    EXPECT_EQ(scan.points_L[i], truth[i].second);
  }
}

TEST(RecordingReading, ReadsTheKittiDrive) {
  PLLIT_RECORDING(path, "kitti_0005/kitti_0005.bag");
  auto source = open_bags({path});
  ASSERT_TRUE(source) << source.error().message;
  std::vector<Time> scan_starts, imu_times;
  for (auto event = (*source)->next(); event && *event; event = (*source)->next()) {
    if (const auto* imu = std::get_if<ImuSample>(&(*event)->data)) imu_times.push_back(imu->time);
    const auto* scan = std::get_if<LidarScan>(&(*event)->data);
    if (scan == nullptr) continue;
    scan_starts.push_back(scan->start);
    EXPECT_GT(scan->points_L.size(), 40'000u);
    EXPECT_TRUE(std::ranges::is_sorted(scan->offsets));
    EXPECT_NEAR(to_seconds(scan->offsets.back()), 0.1, 0.02);
  }
  EXPECT_EQ(scan_starts.size(), 154u);
  EXPECT_NEAR(static_cast<double>(imu_times.size()), 154.0, 6.0);
  EXPECT_TRUE(std::ranges::is_sorted(scan_starts));
  EXPECT_TRUE(std::ranges::is_sorted(imu_times));
  EXPECT_NEAR(to_seconds(scan_starts.back() - scan_starts.front()), 15.9, 0.3);
  EXPECT_EQ((*source)->time_layout()->unit, TimeUnit::seconds);
  EXPECT_FALSE((*source)->time_layout()->absolute);
}

}  // namespace
}  // namespace pllit
