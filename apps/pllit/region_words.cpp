#include "region_words.hpp"

#include <format>

namespace pllit::app {
namespace {

using Json = nlohmann::ordered_json;

Json values_json(const std::optional<RegionValues>& values) {
  if (!values) return {};
  return {{"mean", values->mean}, {"p95", values->p95}, {"max", values->max}};
}

Json judged_json(const std::optional<bool>& judged) { return judged ? Json(*judged) : Json(); }

}  // namespace

Json reading_json(const RegionReading& reading) {
  return {{"seen", reading.seen()},
          {"voxels",
           {{"baseline", reading.baseline_voxels},
            {"seen_again", reading.seen_again},
            {"share", reading.baseline_voxels > 0 ? Json(reading.seen_share()) : Json()},
            {"now", reading.voxels}}},
          {"intensity", values_json(reading.brought)},
          {"own", values_json(reading.own)},
          {"change", reading.change ? Json{{"mean", reading.change->mean}, {"max", reading.change->max}} : Json()},
          {"exceeded",
           {{"change", judged_json(reading.change_exceeded)}, {"kelvin", judged_json(reading.kelvin_exceeded)}}}};
}

std::string reading_text(const RegionReading& reading, IntensityUnit unit) {
  if (!reading.seen()) return reading.baseline_voxels > 0 ? "not seen" : "not seen, nor by the baseline";
  std::string text = reading.baseline_voxels > 0
                         ? std::format("seen {:3.0f} % ({} voxels)", 100.0 * reading.seen_share(), reading.seen_again)
                         : std::format("not seen by the baseline, now {} voxels", reading.voxels);
  if (!reading.brought) return text + "; its intensities cannot be brought to the baseline's";
  text += std::format("; {:.1f} {} on average, {:.1f} at 95 %, {:.1f} at most", reading.brought->mean, name_of(unit),
                      reading.brought->p95, reading.brought->max);
  if (reading.change)
    text += std::format("; change {:+.1f} on average, {:+.1f} at most", reading.change->mean, reading.change->max);
  if (reading.exceeded()) return text + "; LIMIT EXCEEDED";
  return text + (reading.change_exceeded || reading.kelvin_exceeded ? "; within its limits" : "");
}

}  // namespace pllit::app
