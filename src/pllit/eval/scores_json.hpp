// Scores as JSON, in the keys that `run --json`, run.json and `eval --json` share.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "pllit/eval/evaluate.hpp"

namespace pllit {

/// {"matched", "length_m", "align", "ape": {"rmse", "mean", "median", "std", "max" (metres), "rotation_deg": {same}},
/// "rpe": [{"delta_m", "rmse" (metres), "percent", "yaw_deg", "rotation_deg", "pairs"}]}. A delta without pairs has
/// null figures. Keys may be added, never changed.
nlohmann::ordered_json scores_json(const Scores& scores);

}  // namespace pllit
