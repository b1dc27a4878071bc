// A table of severity as a file that people write; docs/ANOMALIES.md says what it holds.
#pragma once

#include <string_view>

#include "pllit/base/error.hpp"
#include "pllit/report/severity.hpp"

namespace pllit {

/// The table of a YAML text. Errors (input) name every mistake as SOURCE:LINE: what, and what to do: unknown keys,
/// bounds that do not ascend, classes without a name or with that of another.
Expected<SeverityTable> parse_severity(std::string_view yaml_text, std::string_view source_name);

}  // namespace pllit
