// A run's summary as JSON (the keys are a promise to other programs) and as a table for people.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pllit/slam/run.hpp"

namespace pllit::app {

/// What run.json says of a run; `schema_version` first.
nlohmann::ordered_json summary_json(const RunSummary& summary);
/// The camera's pose on the rig and delay as refined, what they have moved by from `rig`, and one sigma of that.
nlohmann::ordered_json camera_json(const RefinedMount& mount, const Rig& rig);
/// The same as text, scores included where `json` holds them, in a few lines.
std::string summary_text(const nlohmann::ordered_json& json);

}  // namespace pllit::app
