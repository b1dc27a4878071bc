#include "pllit/sim/world/lidar_patterns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "pllit/sim/world/lidar_models.hpp"

namespace pllit {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<Beam> beams_of_scan(const BeamPattern& pattern, std::int64_t scan) {
  std::vector<Beam> beams;
  for (std::int64_t shot = first_shot_of(pattern, scan); shot < first_shot_of(pattern, scan + 1); ++shot)
    for (const Beam& beam : beams_of(pattern, scan, shot)) beams.push_back(beam);
  return beams;
}

double azimuth_deg(const Beam& beam) { return std::atan2(beam.direction_L.y(), beam.direction_L.x()) / kDegree; }
double elevation_deg(const Beam& beam) { return std::asin(beam.direction_L.z()) / kDegree; }

class EveryLidar : public ::testing::TestWithParam<const char*> {
 protected:
  BeamPattern pattern() const { return lidar_model(GetParam())->pattern; }
};

TEST_P(EveryLidar, PulsesAscendInTimeAndFillTheScan) {
  for (const std::int64_t scan : {0, 1, 17, 36000}) {
    const auto beams = beams_of_scan(pattern(), scan);
    EXPECT_GE(beams.front().offset, Duration(0));
    EXPECT_LT(beams.front().offset, pattern().shot_period);
    EXPECT_GT(beams.back().offset, pattern().scan_period - pattern().shot_period);
    EXPECT_LT(beams.back().offset, pattern().scan_period + pattern().shot_period);
    for (std::size_t i = 1; i < beams.size(); ++i) ASSERT_LE(beams[i - 1].offset, beams[i].offset);
    for (const Beam& beam : beams) ASSERT_NEAR(beam.direction_L.norm(), 1.0, 1e-12);
  }
}

TEST_P(EveryLidar, NoPulseIsLostOrDoubledBetweenScans) {
  std::int64_t shots = 0;
  for (std::int64_t scan = 0; scan < 50; ++scan)
    shots += first_shot_of(pattern(), scan + 1) - first_shot_of(pattern(), scan);
  EXPECT_EQ(shots, (Duration(std::chrono::seconds(5)) + pattern().shot_period - Duration(1)) / pattern().shot_period);
}

INSTANTIATE_TEST_SUITE_P(Lidars, EveryLidar, ::testing::Values("xt32", "vlp16", "hdl64e", "horizon", "mid360"));

struct Turning {
  const char* name;
  std::size_t rings;
  double lowest_deg, highest_deg;
  double step_deg;
  std::size_t pulses;  ///< a scan, at least; at most one shot more
};

class TurningLidar : public ::testing::TestWithParam<Turning> {};

TEST_P(TurningLidar, HasTheRingsStepAndRateOfItsDataSheet) {
  const Turning& sheet = GetParam();
  const BeamPattern pattern = lidar_model(sheet.name)->pattern;
  const auto beams = beams_of_scan(pattern, 3);
  EXPECT_GE(beams.size(), sheet.pulses);
  EXPECT_LE(beams.size(), sheet.pulses + sheet.rings);
  std::map<int, double> elevation_of_line;
  for (const Beam& beam : beams) {
    const auto [entry, is_new] = elevation_of_line.emplace(beam.line, elevation_deg(beam));
    ASSERT_NEAR(entry->second, elevation_deg(beam), 1e-9) << "a ring is level";
  }
  ASSERT_EQ(elevation_of_line.size(), sheet.rings);
  const auto [low, high] =
      std::minmax(elevation_of_line.begin()->second, elevation_of_line.rbegin()->second, std::less<>());
  EXPECT_NEAR(low, sheet.lowest_deg, 1e-9);
  EXPECT_NEAR(high, sheet.highest_deg, 1e-9);
  for (std::size_t i = sheet.rings; i < beams.size(); ++i) {
    const double turned_deg = std::remainder(azimuth_deg(beams[i - sheet.rings]) - azimuth_deg(beams[i]), 360.0);
    ASSERT_NEAR(turned_deg, sheet.step_deg, 1e-6) << "clockwise seen from above";
  }
}

TEST_P(TurningLidar, TheHeadTurnsOnWhileAShotsLasersFire) {
  const BeamPattern pattern = lidar_model(GetParam().name)->pattern;
  const auto beams = beams_of_scan(pattern, 0);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const double expected_deg = -3600.0 * to_seconds(beams[i].offset);
    ASSERT_NEAR(std::remainder(azimuth_deg(beams[i]) - expected_deg, 360.0), 0.0, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Lidars, TurningLidar,
                         ::testing::Values(Turning{"xt32", 32, -16.0, 15.0, 0.18, 64'000},
                                           Turning{"vlp16", 16, -15.0, 15.0, 0.1990656, 28'928},
                                           Turning{"hdl64e", 64, -24.33, 2.0, 0.1728, 133'312}));

TEST(TurningLidars, Hdl64eHasItsTwoBlocksOfRings) {
  std::map<int, double> elevation_of_line;
  for (const Beam& beam : beams_of_scan(velodyne_hdl64e_pattern(), 0))
    elevation_of_line[beam.line] = elevation_deg(beam);
  for (int line = 1; line < 32; ++line) EXPECT_NEAR(elevation_of_line[line] - elevation_of_line[line - 1], 0.5, 1e-9);
  for (int line = 33; line < 64; ++line)
    EXPECT_NEAR(elevation_of_line[line] - elevation_of_line[line - 1], 1.0 / 3.0, 1e-9);
}

/// Cells of a field of view in degrees, and which were met.
class Coverage {
 public:
  Coverage(double low_az, double high_az, double low_el, double high_el, double cell)
      : low_az_(low_az),
        low_el_(low_el),
        cell_(cell),
        columns_(static_cast<int>((high_az - low_az) / cell)),
        rows_(static_cast<int>((high_el - low_el) / cell)) {}

  void add(const Beam& beam) {
    const int column = static_cast<int>(std::floor((azimuth_deg(beam) - low_az_) / cell_));
    const int row = static_cast<int>(std::floor((elevation_deg(beam) - low_el_) / cell_));
    if (column >= 0 && column < columns_ && row >= 0 && row < rows_) met_.insert(column * rows_ + row);
  }
  double share() const { return static_cast<double>(met_.size()) / (columns_ * rows_); }

 private:
  double low_az_, low_el_, cell_;
  int columns_, rows_;
  std::set<int> met_;
};

TEST(LivoxHorizon, CoversItsFieldOfViewAsPublished) {
  const BeamPattern pattern = livox_horizon_pattern();
  Coverage coverage(-40.85, 40.85, -12.55, 12.55, 0.3);
  double widest_deg = 0.0, highest_deg = 0.0, first = 0.0;
  for (std::int64_t scan = 0; scan < 10; ++scan) {
    const auto beams = beams_of_scan(pattern, scan);
    EXPECT_EQ(beams.size(), 24'000U);
    for (const Beam& beam : beams) {
      coverage.add(beam);
      widest_deg = std::max(widest_deg, std::abs(azimuth_deg(beam)));
      highest_deg = std::max(highest_deg, std::abs(elevation_deg(beam)));
    }
    if (scan == 0) first = coverage.share();
  }
  EXPECT_NEAR(widest_deg, 81.7 / 2.0, 0.1);
  EXPECT_NEAR(highest_deg, 25.1 / 2.0, 0.05);
  EXPECT_NEAR(first, 0.6, 0.1);
  EXPECT_GT(coverage.share(), 0.97);
}

TEST(LivoxMid360, LooksAllAroundAndFillsItsFieldOfViewWithTime) {
  const BeamPattern pattern = livox_mid360_pattern();
  Coverage coverage(-180.0, 180.0, -5.0, 50.0, 1.0);
  double lowest_deg = 90.0, highest_deg = -90.0, first = 0.0;
  for (std::int64_t scan = 0; scan < 10; ++scan) {
    const auto beams = beams_of_scan(pattern, scan);
    EXPECT_EQ(beams.size(), 20'000U);
    for (const Beam& beam : beams) {
      coverage.add(beam);
      lowest_deg = std::min(lowest_deg, elevation_deg(beam));
      highest_deg = std::max(highest_deg, elevation_deg(beam));
    }
    if (scan == 0) first = coverage.share();
  }
  EXPECT_NEAR(lowest_deg, -7.0, 0.2);
  EXPECT_NEAR(highest_deg, 52.0, 0.2);
  EXPECT_LT(first, 0.7);
  EXPECT_GT(coverage.share(), 0.98);
}

TEST(Livoxes, DoNotRepeatTheirPatternFromScanToScan) {
  for (const BeamPattern& pattern : {livox_horizon_pattern(), livox_mid360_pattern()})
    for (std::int64_t later = 1; later < 20; ++later) {
      const auto first = beams_of_scan(pattern, 0), other = beams_of_scan(pattern, later);
      double apart = 0.0;
      for (std::size_t i = 0; i < first.size(); ++i) apart += (first[i].direction_L - other[i].direction_L).norm();
      EXPECT_GT(apart / static_cast<double>(first.size()), 1.0 * kDegree);
    }
}

TEST(LidarModels, AnUnknownNameIsAnErrorThatListsTheKnown) {
  const auto unknown = lidar_model("vlp32");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().kind, Error::Kind::input);
  for (const char* name : {"vlp32", "xt32", "vlp16", "hdl64e", "horizon", "mid360"})
    EXPECT_NE(unknown.error().message.find(name), std::string::npos);
}

}  // namespace
}  // namespace pllit
