#include "pllit/slam/thermography_config.hpp"

#include <limits>

namespace pllit {
namespace {

void fill(double& threshold, double value) {
  if (threshold == 0.0) threshold = value;
}

AnchorConfig::Shape usual_shape(IntensityUnit unit) {
  using Shape = AnchorConfig::Shape;
  return unit == IntensityUnit::grey ? Shape::curve : unit == IntensityUnit::count ? Shape::affine : Shape::bias;
}

}  // namespace

ThermographyConfig open_thresholds() {
  ThermographyConfig config;
  VoxelModelConfig& model = config.map.model;
  model.noise = model.min_change = model.adaptation = config.anchor.loss = 0.0;
  model.learned_after = model.learned_views = 0;
  config.anomalies.watch.seam_voxels = -1;
  return config;
}

IntensityUnit unit_of(const ThermographyConfig& config, bool eight_bits) {
  switch (config.unit_choice) {
    case UnitChoice::grey:
      return IntensityUnit::grey;
    case UnitChoice::count:
      return IntensityUnit::count;
    case UnitChoice::kelvin:
      return IntensityUnit::kelvin;
    case UnitChoice::light:
    case UnitChoice::automatic:
      break;
  }
  return eight_bits ? IntensityUnit::grey : IntensityUnit::count;
}

ThermographyConfig by_unit(ThermographyConfig config, IntensityUnit unit) {
  constexpr double kUsual = 30.0;  // counts a kelvin of uncooled 14-bit cameras
  config.unit = unit;
  const bool grey = unit == IntensityUnit::grey;
  const double kelvin = unit == IntensityUnit::kelvin    ? 1.0
                        : config.counts_per_kelvin > 0.0 ? config.counts_per_kelvin
                                                         : kUsual;
  VoxelModelConfig& model = config.map.model;
  WatchConfig& watch = config.anomalies.watch;
  config.anchor.shape = config.anchor_choice.value_or(usual_shape(unit));
  fill(model.noise, grey ? 6.0 : 0.3 * kelvin);
  fill(model.min_change, grey ? 30.0 : 3.0 * kelvin);
  fill(model.adaptation, grey ? 0.02 : 0.005);
  fill(config.anchor.loss, grey ? 12.0 : 1.5 * kelvin);
  if (model.learned_after == 0) model.learned_after = grey ? 12 : 6;
  if (watch.seam_voxels < 0) watch.seam_voxels = grey ? 2 : 0;
  if (config.unit == IntensityUnit::count) config.anchor.slope_sigma = config.anchor.affine_slope_doubt = 0.02;
  watch.bent_curves = config.anchor.shape == AnchorConfig::Shape::curve;
  if (model.learned_views == 0) model.learned_views = grey ? 2 : 1;  // one good reading says more than many of video
  if (!grey) model.passing_images = 2;
  config.anomalies.min_outshone = grey ? 0.7 : 0.0;
  if (!watch.bent_curves) {
    watch.least_past_s = 1.0;
    watch.whole_things = true;
    watch.part_share = 0.5;
    watch.part_voxels = 2;
    watch.parts_of_one = 15;
    config.anomalies.enough_seeds = std::numeric_limits<int>::max();
  }
  return config;
}

VisitChangesConfig visit_changes_config(const ThermographyConfig& config) {
  VisitChangesConfig changes;
  changes.min_change = config.map.model.min_change;
  if (config.unit == IntensityUnit::grey) return changes;
  // The weather changes surfaces by more or less, as they stand to it: a line, and not too narrow.
  changes.drift.curve.shape = AnchorConfig::Shape::affine;
  changes.drift.curve.loss = 1.5 * config.anchor.loss;
  changes.drift.curve.affine_slope_doubt = 0.05;
  changes.drift.most_shift = 2.0 * changes.min_change;
  return changes;
}

}  // namespace pllit
