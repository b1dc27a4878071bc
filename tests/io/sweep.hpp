// A sweep of 0.1 s whose point times are known, in any layout.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "pllit/io/point_cloud2.hpp"
#include "support/bag_fixtures.hpp"

namespace pllit::test {

inline constexpr std::size_t kCount = 1001;  // one point every 100 us, a sweep of 0.1 s
inline constexpr Time kStamp{Duration(1'650'000'000'123'456'789)};

inline std::vector<std::int64_t> true_offsets_ns() {
  std::vector<std::int64_t> offsets(kCount);
  for (std::size_t i = 0; i < kCount; ++i) offsets[i] = static_cast<std::int64_t>(i) * 100'000;
  return offsets;
}

/// The sweep with a time column made by `convert(offset_ns)`.
template <class Convert>
CloudMessage sweep(const std::string& name, const Convert& convert) {
  CloudMessage message{.stamp = kStamp, .columns = points_on_a_line(kCount)};
  std::vector<decltype(convert(std::int64_t{}))> times;
  for (const std::int64_t offset_ns : true_offsets_ns()) times.push_back(convert(offset_ns));
  message.columns.push_back(column(name, times));
  return message;
}

inline void expect_sweep(const DecodedScan& decoded, Time start, std::int64_t tolerance_ns) {
  ASSERT_EQ(decoded.scan.points_L.size(), kCount);
  EXPECT_TRUE(decoded.has_time);
  EXPECT_LE(std::abs((decoded.scan.start - start).count()), tolerance_ns);
  EXPECT_EQ(decoded.scan.offsets.front(), Duration{});
  const auto offsets_ns = true_offsets_ns();
  for (std::size_t i = 0; i < kCount; ++i) {
    EXPECT_LE(std::abs(decoded.scan.offsets[i].count() - offsets_ns[i]), tolerance_ns) << i;
    EXPECT_EQ(decoded.scan.points_L[i].x(), 1.0f + static_cast<float>(i));
  }
}

}  // namespace pllit::test
