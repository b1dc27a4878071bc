// A run's summary as JSON (the keys are a promise to other programs) and as a table for people.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pllit/slam/run.hpp"

namespace pllit::app {

/// Keys as docs/OUTPUTS.md lists them; `schema_version` first.
nlohmann::ordered_json summary_json(const RunSummary& summary);
/// The same, scores included where `json` holds them, in a few lines.
std::string summary_text(const nlohmann::ordered_json& json);

}  // namespace pllit::app
