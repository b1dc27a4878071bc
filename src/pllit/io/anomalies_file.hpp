// anomalies.json: the findings of a session; schema in docs/ANOMALIES.md.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/state/anomaly.hpp"

namespace pllit {

/// Raised when keys change their meaning; new keys do not raise it.
inline constexpr int kAnomaliesSchema = 1;

nlohmann::ordered_json anomaly_json(const Anomaly& anomaly);
nlohmann::ordered_json anomalies_json(std::span<const Anomaly> anomalies, IntensityUnit unit);

/// Reads what anomalies_json made. Input errors name the file and the finding that is wrong.
Expected<std::vector<Anomaly>> read_anomalies(const std::filesystem::path& path);

/// What the intensities of that session count.
Expected<IntensityUnit> read_unit(const std::filesystem::path& path);

}  // namespace pllit
