// The store of what visits show of named regions: an SQLite file for each baseline, which other programs may read;
// docs/ANOMALIES.md names its tables.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pllit/base/error.hpp"
#include "pllit/base/time.hpp"
#include "pllit/state/anomaly.hpp"
#include "pllit/state/region.hpp"

namespace pllit {

/// "2026-11-22T03:00:42Z"
std::string utc_of(Time time);

class SqliteDatabase;

/// PRAGMA user_version of a store; raised when tables change.
inline constexpr int kVisitStoreSchema = 1;

/// Who a visit is. Two sessions are of the same visit where their recordings have the same names and they begin within
/// a minute of each other: the recording was run again.
struct VisitIdentity {
  Time start;              ///< of the trajectory, by the sensor clock
  std::string recordings;  ///< names of the files, or the simulator's address
  std::string session;     ///< folder, for people
  std::string program;     ///< version that made the session
};

/// All values of a store are in the scale of one baseline's map.
struct StoreBaseline {
  VisitIdentity visit;
  std::uint64_t digest = 0;  ///< digest_of its map
  IntensityUnit unit = IntensityUnit::grey;
};

struct NamedReading {
  std::string tag;
  std::string definition;  ///< of the region at that time
  RegionReading reading;
};

/// One region over the visits, ascending in time.
struct RegionSeries {
  struct Point {
    VisitIdentity visit;
    std::string definition;
    RegionReading reading;
  };
  std::string tag;
  std::vector<Point> points;
};

class VisitStore {
 public:
  VisitStore(VisitStore&&) noexcept;
  VisitStore& operator=(VisitStore&&) noexcept;
  ~VisitStore();

  /// Opens a store for writing, or begins one. Errors name the file: no store, one of a newer program, of another
  /// baseline or unit, locked, not to be written.
  static Expected<VisitStore> open_for(const std::filesystem::path& path, const StoreBaseline& baseline);
  /// Opens a store that is there, for reading only.
  static Expected<VisitStore> open(const std::filesystem::path& path);

  /// Adds a visit, all or nothing. What was known of the same regions on the same visit is replaced.
  Expected<void> record(const VisitIdentity& visit, const std::vector<NamedReading>& readings);

  /// Every region, by tag.
  Expected<std::vector<RegionSeries>> series();
  const StoreBaseline& baseline() const { return baseline_; }

 private:
  VisitStore(std::unique_ptr<SqliteDatabase> database, StoreBaseline baseline);

  std::unique_ptr<SqliteDatabase> database_;
  StoreBaseline baseline_;
};

}  // namespace pllit
