// The part of `pllit compare` that is about named regions: reads them, looks them up on each visit, keeps what was
// found.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pllit/io/session.hpp"
#include "pllit/io/visit_store.hpp"
#include "pllit/map/radiometry.hpp"
#include "pllit/map/visit_drift.hpp"
#include "pllit/state/table.hpp"

namespace pllit::app {

/// What a session says of itself, but for its maps.
struct SessionFacts {
  VisitIdentity identity;
  IntensityUnit unit = IntensityUnit::grey;
  Radiometry radiometry{};  ///< of temperatures: what they were corrected for
};
Expected<SessionFacts> session_facts(const Session& session);

class RegionComparison {
 public:
  /// Before anything is compared: reads the regions, and opens or begins the store (none where the name is empty).
  /// `heat` is the baseline's thermal map.
  static Expected<RegionComparison> open(const std::filesystem::path& regions, const std::filesystem::path& store,
                                         const Session& baseline, const PointTable& heat);

  /// What a later session shows of each region, as an array. `heat_W` is its thermal map, in the baseline's frame.
  Expected<nlohmann::ordered_json> look(const Session& session, const PointTable& heat_W, const VisitDrift& drift);

  /// Lines on what `look` found last.
  const std::string& text() const { return text_; }
  bool exceeded() const { return exceeded_; }
  /// What the baseline shows, and where all of it comes from.
  nlohmann::ordered_json baseline_json() const;

 private:
  RegionComparison() = default;
  Expected<void> record(const VisitIdentity& visit, const std::vector<RegionReading>& readings);

  std::filesystem::path file_, store_path_;
  std::vector<Region> regions_;
  PointTable baseline_heat_;
  SessionFacts baseline_;
  std::vector<RegionReading> baseline_readings_;
  std::optional<VisitStore> store_;
  std::string text_;
  bool exceeded_ = false;
};

}  // namespace pllit::app
