// How bad a rise in temperature is, by a table that the reader may replace (report/severity_file).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pllit/state/anomaly.hpp"

namespace pllit {

/// A class holds from its bound up to the next one: [from_k, next).
struct SeverityClass {
  double from_k = 0.0;
  std::string name, action;
  bool operator==(const SeverityClass&) const = default;
};

struct SeverityTable {
  std::string scheme;
  std::vector<SeverityClass> classes;  ///< ascending; below the first there is nothing to report
  bool operator==(const SeverityTable&) const = default;
};

/// Rise over a similar component under the same load, after ANSI/NETA MTS table 100.18 (numbers; wording is ours). Its
/// whole degrees leave gaps; here each class reaches up to the next.
SeverityTable neta_100_18();

/// The class of an anomaly; nothing where the unit allows none (greys and raw counts are no temperatures), or below the
/// first bound.
std::optional<SeverityClass> severity_of(const Anomaly& anomaly, IntensityUnit unit, const SeverityTable& table);

}  // namespace pllit
