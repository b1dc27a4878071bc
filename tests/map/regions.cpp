#include "pllit/map/regions.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "support/random_states.hpp"

namespace pllit {
namespace {

using test::Random;

/// Two metres by one of a wall at y = 4 m, 5 cm apart, of 100 grey and a little noise; a pump of 160 grey in its
/// middle.
PointTable wall(double hotter = 0.0, double gain = 1.0, double bias = 0.0) {
  Random random(3);
  PointTable table{.points = {}, .fields = {{"intensity", {}}, {"normal", {}}, {"images", {}}}};
  for (int i = 0; i < 40; ++i)
    for (int k = 0; k < 20; ++k) {
      const bool pump = i >= 16 && i < 24 && k >= 6 && k < 14;
      const double value = 100.0 + random.normal(1.0) + (pump ? 60.0 + hotter : 0.0);
      table.points.emplace_back(0.05F * static_cast<float>(i) + 0.02F, 4.02F, 0.05F * static_cast<float>(k) + 0.02F);
      for (int field : {0, 1}) table.fields[field].values.push_back(static_cast<float>(gain * value + bias));
      table.fields[2].values.push_back(20.0F);
    }
  return table;
}

const Region kPump{.tag = "pump", .min_W = {0.8, 3.9, 0.3}, .max_W = {1.2, 4.1, 0.7}};

BringIntensity bringing(double gain, double bias) {
  return [=](const Vector3d&, double intensity) { return gain * intensity + bias; };
}
const BringIntensity kNothing = [](const Vector3d&, double) { return std::nullopt; };

RegionReading reading(const PointTable& visit, const Region& region, const BringIntensity& drift = bringing(1.0, 0.0)) {
  return region_readings(wall(), visit, drift, std::vector{region}).front();
}

TEST(Region, HoldsThePointsOfItsBox) {
  EXPECT_TRUE(kPump.contains({1.0, 4.0, 0.5}));
  EXPECT_TRUE(kPump.contains(kPump.min_W + Vector3d::Constant(1e-9)));
  EXPECT_FALSE(kPump.contains(kPump.min_W - Vector3d::Constant(1e-9)));
  EXPECT_FALSE(kPump.contains({1.0, 4.2, 0.5}));
}

TEST(Region, IsTurnedAboutTheVerticalThroughItsMiddle) {
  Region slanted{.tag = "bus bar", .min_W = {1.0, 1.9, 0.0}, .max_W = {3.0, 2.1, 1.0}, .yaw_rad = std::numbers::pi / 4};
  EXPECT_TRUE(slanted.contains({2.6, 2.6, 0.5}));
  EXPECT_FALSE(slanted.contains({2.6, 1.4, 0.5}));
  slanted.yaw_rad = -std::numbers::pi / 4;
  EXPECT_TRUE(slanted.contains({2.6, 1.4, 0.5}));
}

TEST(RegionReading, OfTheSameMapShowsNoChange) {
  const RegionReading same = reading(wall(), kPump);
  EXPECT_EQ(same.baseline_voxels, 16);
  EXPECT_EQ(same.seen_again, 16);
  EXPECT_EQ(same.seen_share(), 1.0);
  ASSERT_TRUE(same.brought && same.change);
  EXPECT_NEAR(same.brought->mean, 160.0, 1.0);
  EXPECT_LE(same.brought->mean, same.brought->p95);
  EXPECT_LE(same.brought->p95, same.brought->max);
  EXPECT_NEAR(same.change->mean, 0.0, 1e-4);
  EXPECT_FALSE(same.change_exceeded) << "there is no limit";
}

TEST(RegionReading, TellsItsOwnChangeWhateverTheWeather) {
  // The later visit's camera shows everything at 0.8 of the greys and 30 more.
  const RegionReading hot = reading(wall(25.0, 0.8, 30.0), kPump, bringing(1.0 / 0.8, -30.0 / 0.8));
  ASSERT_TRUE(hot.own && hot.brought && hot.change);
  EXPECT_NEAR(hot.own->mean, 0.8 * 185.0 + 30.0, 1.0);
  EXPECT_NEAR(hot.brought->mean, 185.0, 1.0);
  EXPECT_NEAR(hot.change->mean, 25.0, 0.1);
}

TEST(RegionReading, SaysWhenNothingWasSeen) {
  PointTable elsewhere = wall();
  for (Vector3f& p : elsewhere.points) p.x() += 10.0F;
  const RegionReading unseen = reading(elsewhere, kPump);
  EXPECT_FALSE(unseen.seen());
  EXPECT_EQ(unseen.baseline_voxels, 16);
  EXPECT_EQ(unseen.seen_share(), 0.0);
  EXPECT_FALSE(unseen.own || unseen.brought || unseen.change);
}

TEST(RegionReading, CountsOnlySurfacesSeenOftenEnough) {
  PointTable glimpsed = wall();
  for (float& images : glimpsed.fields[2].values) images = 3.0F;
  EXPECT_FALSE(reading(glimpsed, kPump).seen());
}

TEST(RegionReading, ClaimsNoChangeWhereNothingBringsTheVisitToTheBaseline) {
  const RegionReading lone = reading(wall(25.0), kPump, kNothing);
  EXPECT_TRUE(lone.seen() && lone.own);
  EXPECT_FALSE(lone.brought || lone.change);
}

TEST(RegionReading, ExceedsALimitWithFourVoxelsAndNotWithThree) {
  Region limited = kPump;
  limited.limits.change = 20.0;
  for (const int hot : {3, 4}) {
    PointTable visit = wall();
    for (std::size_t i = 0; i < visit.points.size(); ++i) {
      const Vector3f& p = visit.points[i];  // a row of voxels, 10 cm each
      if (p.z() > 0.3F && p.z() < 0.4F && p.x() > 0.8F && p.x() < 0.8F + 0.1F * static_cast<float>(hot))
        visit.fields[0].values[i] += 30.0F;
    }
    EXPECT_EQ(reading(visit, limited).change_exceeded, hot == 4) << hot;
  }
}

TEST(RegionReading, JudgesTemperaturesAsTheVisitMeasuredThem) {
  Region limited = kPump;
  limited.limits.kelvin = 180.0;
  const PointTable warmer = wall(0.0, 1.0, 30.0);  // the room is 30 K warmer, and the pump with it
  EXPECT_EQ(reading(warmer, limited, bringing(1.0, -30.0)).kelvin_exceeded, true);
  EXPECT_EQ(reading(wall(), limited).kelvin_exceeded, false);
}

TEST(RegionReading, TakesTheRegionsOwnEmissivityInThePlaceOfTheMaps) {
  Region metal = kPump;
  metal.emissivity = 0.5;
  const auto kelvin = [](double hotter) { return wall(hotter, 0.5, 250.0); };  // 300 K, the pump at 330 K
  const RegionsConfig config{.baseline_radiometry = {.reflected_K = 300.0}, .visit_radiometry = {.reflected_K = 300.0}};
  const auto at = [&](const Region& region) {
    return region_readings(kelvin(0.0), kelvin(10.0), bringing(1.0, 0.0), std::vector{region}, config).front();
  };
  const RadiometricEquation equation(config.visit_radiometry);
  const RegionReading shiny = at(metal), black = at(kPump);
  EXPECT_NEAR(black.own->mean, 335.0, 0.5);
  EXPECT_NEAR(shiny.own->mean, equation.with_emissivity(335.0, 0.5), 0.5);
  EXPECT_NEAR(shiny.change->mean, equation.with_emissivity(335.0, 0.5) - equation.with_emissivity(330.0, 0.5), 0.3);
  EXPECT_GT(shiny.change->mean, 1.5 * black.change->mean);
}

TEST(RegionReading, OfTheBaselineIsTheFirstOfEveryTrend) {
  const auto readings = baseline_readings(wall(), std::vector{kPump});
  ASSERT_EQ(readings.size(), 1u);
  EXPECT_EQ(readings[0].seen_share(), 1.0);
  EXPECT_NEAR(readings[0].brought->mean, 160.0, 1.0);
  EXPECT_EQ(readings[0].change->max, 0.0);
}

TEST(Digest, TellsBaselinesApart) {
  EXPECT_EQ(digest_of(wall()), digest_of(wall()));
  EXPECT_NE(digest_of(wall()), digest_of(wall(0.01)));
}

std::vector<TimedValue> daily(const std::vector<double>& values) {
  std::vector<TimedValue> timed;
  for (const double value : values)
    timed.push_back({time_from_parts(1'700'000'000, 0) + std::chrono::days(timed.size()), value});
  return timed;
}

TEST(Trend, IsTheSlopeADayAndHeedsNoOutlier) {
  const auto even = trend_of(daily({10.0, 12.0, 14.0, 16.0, 18.0}));
  ASSERT_TRUE(even);
  EXPECT_NEAR(even->per_day, 2.0, 1e-9);
  EXPECT_EQ(even->visits, 5);
  EXPECT_NEAR(even->days, 4.0, 1e-9);
  EXPECT_NEAR(trend_of(daily({10.0, 12.0, 90.0, 16.0, 18.0}))->per_day, 2.0, 1e-9);
}

TEST(Trend, TakesThreeVisitsAndAnHour) {
  EXPECT_FALSE(trend_of(daily({10.0, 12.0})));
  std::vector<TimedValue> hasty = daily({10.0, 12.0, 14.0});
  for (TimedValue& value : hasty) value.time = hasty.front().time + (value.time - hasty.front().time) / 1000;
  EXPECT_FALSE(trend_of(hasty));
}

TEST(Trend, DoesNotDependOnTheOrderOfVisits) {
  auto values = daily({10.0, 13.0, 11.0, 17.0, 15.0, 20.0});
  const double forward = trend_of(values)->per_day;
  std::ranges::reverse(values);
  EXPECT_NEAR(trend_of(values)->per_day, forward, 1e-9);
}

}  // namespace
}  // namespace pllit
