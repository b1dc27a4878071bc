#include "pllit/report/severity.hpp"

#include <algorithm>

namespace pllit {

SeverityTable neta_100_18() {
  return {.scheme = "NETA 100.18, rise over what is normal there",
          .classes = {{1.0, "possible", "investigate"},
                      {4.0, "probable", "repair when time permits"},
                      {15.0, "major", "repair at once"}}};
}

std::optional<SeverityClass> severity_of(const Anomaly& anomaly, IntensityUnit unit, const SeverityTable& table) {
  if (unit != IntensityUnit::kelvin) return std::nullopt;
  const auto next = std::ranges::upper_bound(table.classes, anomaly.peak_change, {}, &SeverityClass::from_k);
  if (next == table.classes.begin()) return std::nullopt;
  return *std::prev(next);
}

}  // namespace pllit
