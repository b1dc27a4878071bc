#include "pllit/io/visit_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <format>

#include "pllit/io/file.hpp"
#include "support/full_disk.hpp"
#include "support/temporary_folder.hpp"

namespace pllit {
namespace {

using namespace test;
using testing::AllOf;

using testing::HasSubstr;
namespace fs = std::filesystem;

VisitIdentity visit_on(int day) {
  return {.start = time_from_parts(1'700'000'000, 0) + std::chrono::days(day),
          .recordings = std::format("day{}.bag", day),
          .session = std::format("results/day{}", day),
          .program = "pllit 0.1.0"};
}

NamedReading named(const std::string& tag, double mean) {
  RegionReading reading{.baseline_voxels = 40, .seen_again = 30, .voxels = 35};
  reading.own = RegionValues{mean + 1.0, mean + 2.0, mean + 3.0};
  reading.brought = RegionValues{mean, mean + 5.0, mean + 9.0};
  reading.change = {0.5, 2.5};
  reading.change_exceeded = true;
  return {tag, "[0, 0, 0] to [1, 1, 1] m", reading};
}

class VisitStoreFile : public testing::Test {
 protected:
  Expected<VisitStore> begun() const { return VisitStore::open_for(path_, baseline_); }
  std::vector<RegionSeries> series() const { return VisitStore::open(path_).value().series().value(); }
  std::string error() const {
    const auto store = begun();
    return store ? "" : store.error().message;
  }
  void run_sql(const char* sql) const {
    sqlite3* handle = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &handle), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(handle, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(handle);
    sqlite3_close(handle);
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_ / "hall.sqlite";
  StoreBaseline baseline_{.visit = visit_on(0), .digest = 0xfedcba9876543210ULL, .unit = IntensityUnit::count};
};

TEST_F(VisitStoreFile, GivesBackWhatWasRecordedInOrderOfTime) {
  {
    auto store = begun();
    ASSERT_TRUE(store) << store.error().message;
    ASSERT_TRUE(store->record(visit_on(5), {named("valve", 50.0), named("pump", 105.0)}));
    ASSERT_TRUE(store->record(visit_on(2), {named("pump", 102.0)}));
  }
  const auto all = series();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].tag, "pump");
  ASSERT_EQ(all[0].points.size(), 2u);
  EXPECT_EQ(all[0].points[0].visit.start, visit_on(2).start);
  EXPECT_EQ(all[0].points[1].visit.session, "results/day5");
  EXPECT_EQ(all[0].points[1].definition, "[0, 0, 0] to [1, 1, 1] m");
  const RegionReading& reading = all[0].points[1].reading;
  EXPECT_EQ(reading.baseline_voxels, 40);
  EXPECT_EQ(reading.seen_again, 30);
  EXPECT_EQ(reading.voxels, 35);
  EXPECT_EQ(reading.own->max, 108.0);
  EXPECT_EQ(reading.brought->p95, 110.0);
  EXPECT_EQ(reading.change->max, 2.5);
  EXPECT_EQ(reading.change_exceeded, true);
  EXPECT_FALSE(reading.kelvin_exceeded.has_value());
  const auto store = VisitStore::open(path_).value();
  EXPECT_EQ(store.baseline().unit, IntensityUnit::count);
  EXPECT_EQ(store.baseline().digest, baseline_.digest);
  EXPECT_EQ(store.baseline().visit.session, "results/day0");
}

TEST_F(VisitStoreFile, KeepsARegionThatWasNotSeenAsSuch) {
  ASSERT_TRUE(begun().value().record(visit_on(1), {{"pump", "box", {.baseline_voxels = 40}}}));
  const RegionReading reading = series()[0].points[0].reading;
  EXPECT_FALSE(reading.seen());
  EXPECT_FALSE(reading.own || reading.brought || reading.change || reading.change_exceeded);
}

TEST_F(VisitStoreFile, ReplacesAVisitThatIsComparedAgain) {
  auto store = begun().value();
  ASSERT_TRUE(store.record(visit_on(1), {named("pump", 100.0), named("valve", 70.0)}));
  VisitIdentity again = visit_on(1);  // the same recording run by another version, which started a few frames later
  again.start += std::chrono::milliseconds(300);
  again.program = "pllit 0.2.0";
  ASSERT_TRUE(store.record(again, {named("pump", 120.0)}));
  const auto all = series();
  ASSERT_EQ(all.size(), 2u);
  ASSERT_EQ(all[0].points.size(), 1u);
  EXPECT_EQ(all[0].points[0].reading.brought->mean, 120.0);
  EXPECT_EQ(all[0].points[0].visit.program, "pllit 0.2.0");
  EXPECT_EQ(all[1].points[0].reading.brought->mean, 70.0) << "other regions of the visit stay";
}

TEST_F(VisitStoreFile, TellsVisitsApartByTimeAndByRecording) {
  auto store = begun().value();
  VisitIdentity later = visit_on(1), other = visit_on(1);
  later.start += std::chrono::minutes(5);
  other.recordings = "second_robot.bag";
  for (const VisitIdentity& visit : {visit_on(1), later, other}) ASSERT_TRUE(store.record(visit, {named("pump", 1.0)}));
  EXPECT_EQ(series()[0].points.size(), 3u);
}

TEST_F(VisitStoreFile, TakesNoVisitsInTheScaleOfAnotherBaseline) {
  ASSERT_TRUE(begun());
  ASSERT_TRUE(begun()) << "the same baseline may go on";
  baseline_.digest += 1;
  EXPECT_THAT(error(), AllOf(HasSubstr("hall.sqlite: holds visits in the scale of another baseline ('results/day0', "
                                       "begun 2023-11-14T22:13:20Z)"),
                             HasSubstr("a store of its own")));
}

TEST_F(VisitStoreFile, RefusesFilesThatAreNoStore) {
  ASSERT_TRUE(write_file(path_, "these are the notes of last Monday, and no database at all\n"));
  EXPECT_THAT(error(), HasSubstr("hall.sqlite: is no SQLite file, so no store of visits"));
  EXPECT_THAT(VisitStore::open(path_).error().message, HasSubstr("is no SQLite file"));
  fs::remove(path_);
  EXPECT_THAT(VisitStore::open(path_).error().message, HasSubstr("no such file"));
  run_sql("CREATE TABLE photos (name TEXT)");
  EXPECT_THAT(error(), HasSubstr("is an SQLite file of another program"));
  EXPECT_THAT(VisitStore::open(folder_.path()).error().message, HasSubstr("is a folder"));
  path_ = folder_ / "none/hall.sqlite";
  EXPECT_THAT(error(), HasSubstr("its folder does not exist"));
}

TEST_F(VisitStoreFile, RefusesTheSchemaOfANewerProgram) {
  ASSERT_TRUE(begun());
  run_sql("PRAGMA user_version = 2");
  EXPECT_THAT(error(), HasSubstr("was made by a newer pllit (schema 2, this one knows 1)"));
  EXPECT_THAT(VisitStore::open(path_).error().message, HasSubstr("newer pllit"));
}

TEST_F(VisitStoreFile, SaysThatAnotherProgramIsWriting) {
  ASSERT_TRUE(begun());
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  const auto store = begun();
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().kind, Error::Kind::failure);
  EXPECT_THAT(store.error().message, HasSubstr("hall.sqlite: another program is writing to it"));
  sqlite3_close(other);
  EXPECT_TRUE(begun());
}

TEST_F(VisitStoreFile, SaysThatItMayOnlyBeRead) {
  ASSERT_TRUE(begun().value().record(visit_on(1), {named("pump", 100.0)}));
  fs::permissions(folder_.path(), fs::perms::all);
  fs::permissions(path_, fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
  const bool is_root = geteuid() == 0;  // whom permissions do not hold back
  ASSERT_TRUE(!is_root || seteuid(65534) == 0);
  const std::string message = error();
  const bool readable = VisitStore::open(path_).has_value();
  ASSERT_TRUE(!is_root || seteuid(0) == 0);
  EXPECT_THAT(message, HasSubstr("hall.sqlite: may only be read; name a file that may be written"));
  EXPECT_TRUE(readable);
}

TEST_F(VisitStoreFile, HoldsWhatItHeldWhereTheDiskFillsUp) {
  auto store = begun().value();
  ASSERT_TRUE(store.record(visit_on(1), {named("pump", 100.0)}));
  {
    const FullDisk full(fs::file_size(path_));
    std::vector<NamedReading> many;
    for (int i = 0; i < 2000; ++i) many.push_back(named(std::format("region {}", i), 1.0));
    const auto recorded = store.record(visit_on(2), many);
    ASSERT_FALSE(recorded);
    EXPECT_EQ(recorded.error().kind, Error::Kind::failure);
    EXPECT_THAT(recorded.error().message, AllOf(HasSubstr("hall.sqlite: cannot be written"), HasSubstr("held before")));
  }
  ASSERT_EQ(series().size(), 1u);
  EXPECT_EQ(series()[0].points.size(), 1u);
  EXPECT_TRUE(store.record(visit_on(2), {named("pump", 101.0)})) << "and goes on once there is room";
  EXPECT_EQ(series()[0].points.size(), 2u);
}

TEST_F(VisitStoreFile, ForgetsWhatAKillLeftHalfDone) {
  ASSERT_TRUE(begun().value().record(visit_on(1), {named("pump", 100.0)}));
  const pid_t child = fork();
  if (child == 0) {
    sqlite3* handle = nullptr;
    sqlite3_open(path_.c_str(), &handle);
    sqlite3_exec(handle,
                 "PRAGMA cache_size = 1; BEGIN; UPDATE reading SET mean = -1.0; CREATE TABLE much (x); "
                 "INSERT INTO much SELECT zeroblob(500000); INSERT INTO much SELECT zeroblob(500000);",
                 nullptr, nullptr, nullptr);
    std::raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  EXPECT_TRUE(fs::exists(path_.string() + "-journal"));
  EXPECT_EQ(series()[0].points[0].reading.brought->mean, 100.0);
}

}  // namespace
}  // namespace pllit
