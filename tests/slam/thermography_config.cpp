#include "pllit/slam/thermography_config.hpp"

#include <gtest/gtest.h>

#include "pllit/slam/config_yaml.hpp"

namespace pllit {
namespace {

ThermographyConfig with_unit(IntensityUnit unit) { return by_unit(open_thresholds(), unit); }

TEST(ThermographyConfig, TakesTheUnitFromTheImagesWhereTheUserDoesNotSay) {
  ThermographyConfig config = open_thresholds();
  EXPECT_EQ(unit_of(config, true), IntensityUnit::grey);
  EXPECT_EQ(unit_of(config, false), IntensityUnit::count);
  config.unit_choice = UnitChoice::kelvin;
  EXPECT_EQ(unit_of(config, false), IntensityUnit::kelvin);
}

TEST(ThermographyConfig, FillsInWhatSuitsTheUnit) {
  const ThermographyConfig grey = with_unit(IntensityUnit::grey), count = with_unit(IntensityUnit::count),
                           kelvin = with_unit(IntensityUnit::kelvin);
  EXPECT_EQ(grey.map.model.min_change, 30.0);
  EXPECT_EQ(count.map.model.min_change, 90.0) << "3 K of a usual camera";
  EXPECT_EQ(kelvin.map.model.min_change, 3.0) << "30 K would be most faults";
  EXPECT_EQ(grey.anchor.shape, AnchorConfig::Shape::curve);
  EXPECT_GT(grey.anomalies.min_outshone, 0.5) << "of video only the order is certain";
  EXPECT_EQ(count.anomalies.min_outshone, 0.0);
  EXPECT_EQ(count.anchor.shape, AnchorConfig::Shape::affine);
  EXPECT_EQ(kelvin.anchor.shape, AnchorConfig::Shape::bias);
  for (const ThermographyConfig& config : {grey, count, kelvin}) {
    EXPECT_GT(config.map.model.noise, 0.0);
    EXPECT_GT(config.map.model.adaptation, 0.0);
    EXPECT_GT(config.map.model.learned_after, 1);
    EXPECT_GT(config.anchor.loss, config.map.model.noise);
    EXPECT_GE(config.anomalies.watch.seam_voxels, 0);
  }
}

TEST(ThermographyConfig, MeasuresCountsInTheUsersKelvin) {
  ThermographyConfig config = open_thresholds();
  config.counts_per_kelvin = 100.0;
  EXPECT_NEAR(by_unit(config, IntensityUnit::count).map.model.min_change, 300.0, 1e-9);
  EXPECT_NEAR(by_unit(config, IntensityUnit::count).map.model.noise, 30.0, 1e-9);
}

TEST(ThermographyConfig, LeavesWhatTheUserChose) {
  auto config = load_config(
      "advanced: {anomalies: {unit: count, min_change: 45, anchor: bias, seam_voxels: 1, learned_after: 9, "
      "learned_views: 3}}",
      "a.yaml");
  ASSERT_TRUE(config) << config.error().message;
  const ThermographyConfig chosen = by_unit(config->thermography, unit_of(config->thermography, true));
  EXPECT_EQ(chosen.map.model.min_change, 45.0);
  EXPECT_EQ(chosen.anchor.shape, AnchorConfig::Shape::bias);
  EXPECT_EQ(chosen.anomalies.watch.seam_voxels, 1);
  EXPECT_EQ(chosen.map.model.learned_after, 9);
  EXPECT_EQ(chosen.map.model.learned_views, 3);
  EXPECT_NEAR(chosen.map.model.noise, 9.0, 1e-9) << "the others suit the unit";
}

TEST(ThermographyConfig, ComparesVisitsInTheirUnit) {
  EXPECT_EQ(visit_changes_config(with_unit(IntensityUnit::grey)).min_change, 30.0);
  EXPECT_EQ(visit_changes_config(with_unit(IntensityUnit::count)).min_change, 90.0);
  EXPECT_EQ(visit_changes_config(with_unit(IntensityUnit::kelvin)).min_change, 3.0);
}

TEST(ThermographyConfig, IsFilledInOnceForAll) {
  for (const IntensityUnit unit : {IntensityUnit::grey, IntensityUnit::count, IntensityUnit::kelvin}) {
    const ThermographyConfig once = with_unit(unit), twice = by_unit(once, unit);
    EXPECT_EQ(once.map.model.noise, twice.map.model.noise);
    EXPECT_EQ(once.anchor.loss, twice.anchor.loss);
    EXPECT_EQ(once.anchor.shape, twice.anchor.shape);
  }
}

}  // namespace
}  // namespace pllit
