// What was read of named regions, in words and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pllit/state/anomaly.hpp"
#include "pllit/state/region.hpp"

namespace pllit::app {

/// Keys `seen`, `voxels`, `intensity` (brought to the baseline), `own`, `change` and `exceeded`; null where there is
/// nothing to say.
nlohmann::ordered_json reading_json(const RegionReading& reading);

/// One line without its end.
std::string reading_text(const RegionReading& reading, IntensityUnit unit);

}  // namespace pllit::app
