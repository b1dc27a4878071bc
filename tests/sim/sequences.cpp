#include "pllit/sim/sequences.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "pllit/sim/config.hpp"
#include "pllit/slam/config_presets.hpp"

namespace pllit {
namespace {

using testing::HasSubstr;

TEST(Sequences, AreThePapersRowsAndOursEachInAWorldOfItsOwn) {
  const auto table = parse_sequences(sequences_yaml());
  ASSERT_TRUE(table) << table.error().message;
  std::vector<std::string> names;
  std::set<std::uint64_t> worlds;
  for (const Sequence& row : *table) {
    names.push_back(row.name);
    worlds.insert(row.world);
    EXPECT_TRUE(find_config(row.config)) << row.name;
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("H04", "H05", "H06", "H14", "H16", "H18", "N1", "N2", "N3", "A1",
                                                   "A2", "A3", "C1", "C2", "S1", "S2"));
  EXPECT_EQ(worlds.size(), names.size());
}

TEST(Sequences, BecomeAddressesWithTheSeedInTheirWorld) {
  EXPECT_EQ(expanded_address("sim:A1").value(), "sim:room?rig=inspection&finding=table&images=counts&seed=41000");
  EXPECT_EQ(expanded_address("sim:A1?seed=7&duration=20").value(),
            "sim:room?rig=inspection&finding=table&images=counts&duration=20&seed=41007");
  EXPECT_EQ(expanded_address("sim:A1?finding=none").value(),
            "sim:room?rig=inspection&images=counts&finding=none&seed=41000");
  EXPECT_EQ(expanded_address("sim:room?seed=3").value(), "sim:room?seed=3");
  EXPECT_EQ(expanded_address("drive.bag").value(), "drive.bag");
}

TEST(Sequences, RefuseASeedThatWouldBeAnotherRowsWorld) {
  for (const char* address : {"sim:A1?seed=1000", "sim:A1?seed=-1", "sim:A1?seed=x"}) {
    const auto expanded = expanded_address(address);
    ASSERT_FALSE(expanded) << address;
    EXPECT_THAT(expanded.error().message, HasSubstr("0 to 999"));
  }
}

TEST(Sequences, NameTheRowThatIsWrong) {
  const auto error = [](const char* yaml) { return parse_sequences(yaml).error().message; };
  EXPECT_THAT(error("rows: {X: {source: 'sim:room', world: 1, config: kitti}}"),
              testing::AllOf(HasSubstr("row X"), HasSubstr("tier")));
  EXPECT_THAT(error("rows: {X: {source: 'sim:rom?a=1', world: 1, config: kitti, tier: full}}"),
              HasSubstr("did you mean room"));
  EXPECT_THAT(error("rows: {X: {source: 'sim:room', world: 1, config: kitti, tier: huge}}"),
              HasSubstr("smoke, short or full"));
}

}  // namespace
}  // namespace pllit
