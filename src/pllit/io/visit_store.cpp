#include "pllit/io/visit_store.hpp"

#include <array>
#include <cstdlib>
#include <format>

#include "pllit/io/sqlite.hpp"

namespace pllit {
namespace {

constexpr std::int64_t kApplication = 0x504c4954;  // "PLIT", by which the file tells itself from other SQLite files
constexpr std::int64_t kSameVisit_ns = 60'000'000'000;

constexpr const char* kTables = R"(
CREATE TABLE baseline (digest TEXT NOT NULL, unit TEXT NOT NULL, start_ns INTEGER NOT NULL, recordings TEXT NOT NULL,
  session TEXT NOT NULL, program TEXT NOT NULL);
CREATE TABLE visit (id INTEGER PRIMARY KEY, start_ns INTEGER NOT NULL, recordings TEXT NOT NULL, session TEXT NOT NULL,
  program TEXT NOT NULL);
CREATE TABLE reading (visit INTEGER NOT NULL REFERENCES visit (id), tag TEXT NOT NULL, definition TEXT NOT NULL,
  baseline_voxels INTEGER NOT NULL, seen_again INTEGER NOT NULL, voxels INTEGER NOT NULL,
  own_mean REAL, own_p95 REAL, own_max REAL, mean REAL, p95 REAL, max REAL, change_mean REAL, change_max REAL,
  change_exceeded INTEGER, kelvin_exceeded INTEGER, PRIMARY KEY (visit, tag));
)";

template <class Work>
Expected<void> in_transaction(SqliteDatabase& database, const Work& work) {
  if (auto begun = database.run("BEGIN IMMEDIATE"); !begun) return begun;
  Expected<void> done = work();
  if (done) done = database.run("COMMIT");
  if (!done) static_cast<void>(database.run("ROLLBACK"));  // what came first is told
  return done;
}

/// Whether the file is a store that this program understands; false where it is empty.
Expected<bool> holds_store(SqliteDatabase& database) {
  const auto application = database.number("PRAGMA application_id");
  if (!application) return std::unexpected(application.error());
  const auto version = database.number("PRAGMA user_version");
  if (!version) return std::unexpected(version.error());
  const auto tables = database.number("SELECT count(*) FROM sqlite_schema");
  if (!tables) return std::unexpected(tables.error());
  const std::string name = database.path().string();
  if (*application == 0 && *version == 0 && *tables == 0) return false;
  if (*application != kApplication)
    return input_error(std::format("{}: is an SQLite file of another program, no store of visits; name another", name));
  if (*version > kVisitStoreSchema)
    return input_error(
        std::format("{}: was made by a newer pllit (schema {}, this one knows {}); use that one, or begin "
                    "another store",
                    name, *version, kVisitStoreSchema));
  if (*version != kVisitStoreSchema)
    return input_error(std::format("{}: has schema {}, which no pllit wrote; name another file", name, *version));
  return true;
}

Expected<void> begin_store(SqliteDatabase& database, const StoreBaseline& baseline) {
  auto made = database.run(
      kTables + std::format("PRAGMA application_id = {}; PRAGMA user_version = {};", kApplication, kVisitStoreSchema));
  if (!made) return made;
  auto row = database.prepare("INSERT INTO baseline VALUES (?, ?, ?, ?, ?, ?)");
  if (!row) return std::unexpected(row.error());
  return row->bind(0, std::format("{:016x}", baseline.digest))
      .bind(1, name_of(baseline.unit))
      .bind(2, nanoseconds_of(baseline.visit.start))
      .bind(3, baseline.visit.recordings)
      .bind(4, baseline.visit.session)
      .bind(5, baseline.visit.program)
      .run();
}

VisitIdentity identity_at(const SqliteStatement& row, int column) {
  return {.start = Time(Duration(row.integer(column))),
          .recordings = row.text(column + 1),
          .session = row.text(column + 2),
          .program = row.text(column + 3)};
}

Expected<StoreBaseline> baseline_in(SqliteDatabase& database) {
  auto row = database.prepare("SELECT digest, unit, start_ns, recordings, session, program FROM baseline");
  if (!row) return std::unexpected(row.error());
  const auto found = row->next();
  if (!found) return std::unexpected(found.error());
  if (!*found)
    return input_error(
        std::format("{}: names no baseline, so it is damaged; begin a new store", database.path().string()));
  StoreBaseline baseline{.visit = identity_at(*row, 2), .digest = std::strtoull(row->text(0).c_str(), nullptr, 16)};
  for (const IntensityUnit unit : {IntensityUnit::grey, IntensityUnit::count, IntensityUnit::kelvin})
    if (row->text(1) == name_of(unit)) baseline.unit = unit;
  return baseline;
}

/// The row of a visit, made where there is none.
Expected<std::int64_t> visit_row(SqliteDatabase& database, const VisitIdentity& visit) {
  auto known = database.prepare("SELECT id FROM visit WHERE recordings = ? AND abs(start_ns - ?) < ?");
  if (!known) return std::unexpected(known.error());
  const auto found =
      known->bind(0, visit.recordings).bind(1, nanoseconds_of(visit.start)).bind(2, kSameVisit_ns).next();
  if (!found) return std::unexpected(found.error());
  auto written = *found ? database.prepare(
                              "UPDATE visit SET start_ns = ?, recordings = ?, session = ?, program = ? "
                              "WHERE id = ?")
                        : database.prepare(
                              "INSERT INTO visit (start_ns, recordings, session, program) "
                              "VALUES (?, ?, ?, ?)");
  if (!written) return std::unexpected(written.error());
  written->bind(0, nanoseconds_of(visit.start)).bind(1, visit.recordings).bind(2, visit.session).bind(3, visit.program);
  if (*found) written->bind(4, known->integer(0));
  if (const auto done = written->run(); !done) return std::unexpected(done.error());
  return *found ? known->integer(0) : database.last_row();
}

Expected<void> write_reading(SqliteDatabase& database, std::int64_t visit, const NamedReading& named) {
  auto row = database.prepare("INSERT OR REPLACE INTO reading VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  if (!row) return std::unexpected(row.error());
  const RegionReading& reading = named.reading;
  row->bind(0, visit).bind(1, named.tag).bind(2, named.definition);
  row->bind(3, std::int64_t{reading.baseline_voxels});
  row->bind(4, std::int64_t{reading.seen_again}).bind(5, std::int64_t{reading.voxels});
  int column = 6;
  for (const auto& values : {reading.own, reading.brought})
    for (const auto member : {&RegionValues::mean, &RegionValues::p95, &RegionValues::max})
      row->bind(column++, values ? std::optional((*values).*member) : std::nullopt);
  for (const auto member : {&RegionReading::Change::mean, &RegionReading::Change::max})
    row->bind(column++, reading.change ? std::optional((*reading.change).*member) : std::nullopt);
  return row->bind(14, reading.change_exceeded).bind(15, reading.kelvin_exceeded).run();
}

RegionReading reading_at(const SqliteStatement& row, int column) {
  RegionReading reading{.baseline_voxels = static_cast<int>(row.integer(column)),
                        .seen_again = static_cast<int>(row.integer(column + 1)),
                        .voxels = static_cast<int>(row.integer(column + 2))};
  const auto values_at = [&](int first) -> std::optional<RegionValues> {
    const auto mean = row.real(first), p95 = row.real(first + 1), max = row.real(first + 2);
    return mean && p95 && max ? std::optional(RegionValues{*mean, *p95, *max}) : std::nullopt;
  };
  reading.own = values_at(column + 3);
  reading.brought = values_at(column + 6);
  const auto mean = row.real(column + 9), max = row.real(column + 10);
  if (mean && max) reading.change = {*mean, *max};
  reading.change_exceeded = row.truth(column + 11);
  reading.kelvin_exceeded = row.truth(column + 12);
  return reading;
}

/// Whether visits compared with this baseline may go into the store.
Expected<void> check_baseline(const std::string& name, const StoreBaseline& held, const StoreBaseline& wanted) {
  if (held.digest == wanted.digest && held.unit == wanted.unit) return {};
  return input_error(std::format(
      "{}: holds visits in the scale of another baseline ('{}', begun {}); give this baseline a store of its own", name,
      held.visit.session, utc_of(held.visit.start)));
}

}  // namespace

std::string utc_of(Time time) { return std::format("{:%FT%TZ}", std::chrono::floor<std::chrono::seconds>(time)); }

VisitStore::VisitStore(std::unique_ptr<SqliteDatabase> database, StoreBaseline baseline)
    : database_(std::move(database)), baseline_(std::move(baseline)) {}
VisitStore::VisitStore(VisitStore&&) noexcept = default;
VisitStore& VisitStore::operator=(VisitStore&&) noexcept = default;
VisitStore::~VisitStore() = default;

Expected<VisitStore> VisitStore::open_for(const std::filesystem::path& path, const StoreBaseline& baseline) {
  auto opened = SqliteDatabase::open(path, SqliteDatabase::Access::write);
  if (!opened) return std::unexpected(opened.error());
  auto database = std::make_unique<SqliteDatabase>(std::move(*opened));
  const auto checked = in_transaction(*database, [&]() -> Expected<void> {
    const auto store = holds_store(*database);
    if (!store) return std::unexpected(store.error());
    if (!*store) return begin_store(*database, baseline);
    const auto held = baseline_in(*database);
    if (!held) return std::unexpected(held.error());
    return check_baseline(path.string(), *held, baseline);
  });
  if (!checked) return std::unexpected(checked.error());
  return VisitStore(std::move(database), baseline);
}

Expected<VisitStore> VisitStore::open(const std::filesystem::path& path) {
  auto opened = SqliteDatabase::open(path, SqliteDatabase::Access::read);
  if (!opened) return std::unexpected(opened.error());
  auto database = std::make_unique<SqliteDatabase>(std::move(*opened));
  const auto store = holds_store(*database);
  if (!store) return std::unexpected(store.error());
  if (!*store) return input_error(std::format("{}: is empty; pllit compare --store fills it", path.string()));
  auto baseline = baseline_in(*database);
  if (!baseline) return std::unexpected(baseline.error());
  return VisitStore(std::move(database), std::move(*baseline));
}

Expected<void> VisitStore::record(const VisitIdentity& visit, const std::vector<NamedReading>& readings) {
  return in_transaction(*database_, [&]() -> Expected<void> {
    const auto row = visit_row(*database_, visit);
    if (!row) return std::unexpected(row.error());
    for (const NamedReading& reading : readings)
      if (auto written = write_reading(*database_, *row, reading); !written) return written;
    return {};
  });
}

Expected<std::vector<RegionSeries>> VisitStore::series() {
  auto row = database_->prepare(
      "SELECT tag, start_ns, recordings, session, program, definition, baseline_voxels, seen_again, voxels, own_mean, "
      "own_p95, own_max, mean, p95, max, change_mean, change_max, change_exceeded, kelvin_exceeded "
      "FROM reading JOIN visit ON visit.id = reading.visit ORDER BY tag, start_ns, visit.id");
  if (!row) return std::unexpected(row.error());
  std::vector<RegionSeries> all;
  for (;;) {
    const auto more = row->next();
    if (!more) return std::unexpected(more.error());
    if (!*more) return all;
    const std::string tag = row->text(0);
    if (all.empty() || all.back().tag != tag) all.push_back({tag, {}});
    all.back().points.push_back({identity_at(*row, 1), row->text(5), reading_at(*row, 6)});
  }
}

}  // namespace pllit
