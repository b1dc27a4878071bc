#include "pllit/io/anomalies_file.hpp"

#include <array>
#include <cmath>
#include <format>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "pllit/geometry/lie_json.hpp"
#include "pllit/io/file.hpp"

namespace pllit {
namespace {

using Json = nlohmann::ordered_json;

Json crop_json(const ImageCrop& crop) {
  return {{"time_s", to_seconds(crop.time)},
          {"left", crop.left},
          {"top", crop.top},
          {"width", crop.width},
          {"height", crop.height}};
}

/// To the microsecond: what a double holds of the seconds since 1970.
Time time_of(const Json& seconds) { return Time(std::chrono::microseconds(std::llround(seconds.get<double>() * 1e6))); }

Vector3d vector_of(const Json& json) {
  const auto v = json.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

/// The value with a name; throws where none has it.
template <class Value, std::size_t N>
Value named(const Json& json, const std::array<Value, N>& values) {
  for (const Value value : values)
    if (json.get<std::string>() == name_of(value)) return value;
  throw std::invalid_argument(std::format("{} is no known word", json.dump()));
}

ImageCrop crop_of(const Json& json) {
  return {.time = time_of(json.at("time_s")),
          .left = json.at("left"),
          .top = json.at("top"),
          .width = json.at("width"),
          .height = json.at("height")};
}

/// Throws where a key is missing or holds something else.
Anomaly anomaly_of(const Json& json) {
  Anomaly anomaly{.id = json.at("id")};
  anomaly.kind = named(json.at("kind"), std::array{AnomalyKind::heated, AnomalyKind::new_hot});
  anomaly.state = named(json.at("state"), std::array{AnomalyState::fresh, AnomalyState::confirmed,
                                                     AnomalyState::cooling, AnomalyState::gone});
  anomaly.position_W = vector_of(json.at("position_m"));
  for (int row = 0; row < 3; ++row)
    anomaly.covariance_m2.row(row) = vector_of(json.at("covariance_m2").at(static_cast<std::size_t>(row))).transpose();
  anomaly.extent_m = vector_of(json.at("extent_m"));
  anomaly.mean_change = json.at("change").at("mean");
  anomaly.peak_change = json.at("change").at("peak");
  anomaly.mean_sigmas = json.at("change_sigmas").at("mean");
  anomaly.peak_sigmas = json.at("change_sigmas").at("peak");
  anomaly.first_seen = time_of(json.at("first_seen_s"));
  if (!json.at("confirmed_s").is_null()) anomaly.confirmed = time_of(json.at("confirmed_s"));
  anomaly.last_seen = time_of(json.at("last_seen_s"));
  anomaly.voxels = json.at("voxels");
  anomaly.frames = json.at("frames");
  anomaly.views = json.at("views");
  anomaly.confidence = json.at("confidence");
  if (!json.at("crop").is_null()) anomaly.crop = crop_of(json.at("crop"));
  return anomaly;
}

/// A file that says to hold anomalies in the present schema.
Expected<Json> anomalies_in(const std::filesystem::path& path) {
  const auto text = read_file(path);
  if (!text) return std::unexpected(text.error());
  const auto wrong = [&](const std::string& what) { return input_error(std::format("{}: {}", path.string(), what)); };
  Json json = Json::parse(*text, nullptr, false);
  if (json.is_discarded()) return wrong("is not JSON");
  if (!json.is_object() || !json.contains("schema_version") || json["schema_version"] != kAnomaliesSchema)
    return wrong(std::format("is no list of anomalies of schema {}", kAnomaliesSchema));
  return json;
}

}  // namespace

Json anomaly_json(const Anomaly& anomaly) {
  Json covariance = Json::array();
  for (int row = 0; row < 3; ++row) covariance.push_back(vector_json(anomaly.covariance_m2.row(row).transpose()));
  return {{"id", anomaly.id},
          {"kind", name_of(anomaly.kind)},
          {"state", name_of(anomaly.state)},
          {"position_m", vector_json(anomaly.position_W)},
          {"covariance_m2", std::move(covariance)},
          {"extent_m", vector_json(anomaly.extent_m)},
          {"change", {{"mean", anomaly.mean_change}, {"peak", anomaly.peak_change}}},
          {"change_sigmas", {{"mean", anomaly.mean_sigmas}, {"peak", anomaly.peak_sigmas}}},
          {"first_seen_s", to_seconds(anomaly.first_seen)},
          {"confirmed_s", anomaly.confirmed ? Json(to_seconds(*anomaly.confirmed)) : Json()},
          {"last_seen_s", to_seconds(anomaly.last_seen)},
          {"voxels", anomaly.voxels},
          {"frames", anomaly.frames},
          {"views", anomaly.views},
          {"confidence", anomaly.confidence},
          {"crop", anomaly.crop ? crop_json(*anomaly.crop) : Json()}};
}

Json anomalies_json(std::span<const Anomaly> anomalies, IntensityUnit unit) {
  Json json{{"schema_version", kAnomaliesSchema}, {"unit", name_of(unit)}, {"anomalies", Json::array()}};
  for (const Anomaly& anomaly : anomalies) json["anomalies"].push_back(anomaly_json(anomaly));
  return json;
}

Expected<std::vector<Anomaly>> read_anomalies(const std::filesystem::path& path) {
  const auto json = anomalies_in(path);
  if (!json) return std::unexpected(json.error());
  std::vector<Anomaly> anomalies;
  try {
    for (const Json& anomaly : json->at("anomalies")) anomalies.push_back(anomaly_of(anomaly));
  } catch (const std::exception& error) {
    return input_error(std::format("{}: finding {}: {}", path.string(), anomalies.size() + 1, error.what()));
  }
  return anomalies;
}

Expected<IntensityUnit> read_unit(const std::filesystem::path& path) {
  const auto json = anomalies_in(path);
  if (!json) return std::unexpected(json.error());
  try {
    return named(json->at("unit"), std::array{IntensityUnit::grey, IntensityUnit::count, IntensityUnit::kelvin});
  } catch (const std::exception& error) {
    return input_error(std::format("{}: unit: {}", path.string(), error.what()));
  }
}

}  // namespace pllit
