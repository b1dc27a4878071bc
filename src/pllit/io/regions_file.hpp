// Named regions as a file that people write; docs/ANOMALIES.md says what it holds.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/state/anomaly.hpp"
#include "pllit/state/region.hpp"

namespace pllit {

/// The regions of a YAML text, in its order. Errors (input) name every mistake as SOURCE:LINE: what, and what to do:
/// unknown keys, boxes that are inverted or none, tags given twice, values of the wrong kind or out of range.
Expected<std::vector<Region>> parse_regions(std::string_view yaml_text, std::string_view source_name);
Expected<std::vector<Region>> read_regions(const std::filesystem::path& path);

/// An input error where a region asks for temperatures of a map that holds none.
Expected<void> check_unit(std::span<const Region> regions, IntensityUnit unit, std::string_view source_name);

/// What readings of a region depend on, as text: where it differs, they cannot be compared.
std::string definition_of(const Region& region);

}  // namespace pllit
