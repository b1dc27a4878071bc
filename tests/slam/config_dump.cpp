#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "config_support.hpp"

namespace pllit {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(ConfigDump, LoadsBackToTheSameConfiguration) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Config config = test::random_config(seed);
    const auto loaded = load_config(dump_config(config), "dump");
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_EQ(*loaded, config) << "seed " << seed;
  }
}

TEST(ConfigDump, KeepsNumbersToTheLastBit) {
  Config config;
  config.map.voxel_m = std::nextafter(0.3, 1.0);
  config.rig.lidar.range_m = {std::nextafter(0.1, 0.0), 100.0 / 3.0};
  const auto loaded = load_config(dump_config(config), "dump");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->map.voxel_m, config.map.voxel_m);
  EXPECT_EQ(loaded->rig.lidar.range_m, config.rig.lidar.range_m);
}

TEST(ConfigEquality, SeesEveryKey) {
  Config defaults;
  const std::size_t count = keys_of(defaults).keys.size();
  for (std::size_t i = 0; i < count; ++i) {
    Config changed;
    Key key = keys_of(changed).keys[i];
    test::RandomValue value(7);
    for (int tries = 0; tries < 50 && changed == defaults; ++tries) value.draw(key);
    EXPECT_FALSE(changed == defaults) << key.path;
  }
}

TEST(ConfigDump, NamesUnitRangeAndDefaultAboveEachKey) {
  Config config;
  config.map.voxel_m = 0.25;
  EXPECT_THAT(dump_config(config), HasSubstr("  # m; 0.05 to 10; default 0.4\n  voxel_m: 0.25\n"));
}

TEST(ConfigKeys, AreAtMostTwentyFiveForUsers) {
  Config config;
  const KeyList keys = keys_of(config);
  const auto user_keys =
      std::ranges::count_if(keys.keys, [](const Key& key) { return !key.path.starts_with(kAdvanced); });
  EXPECT_LE(user_keys, 25);
}

TEST(ConfigKeys, HaveUniqueNamesAndAreExplained) {
  Config config;
  const KeyList keys = keys_of(config);
  for (const Key& key : keys.keys) {
    EXPECT_EQ(std::ranges::count(keys.keys, key.path, &Key::path), 1) << key.path;
    EXPECT_THAT(key.doc, Not(IsEmpty())) << key.path;
    EXPECT_LE(key.doc.size(), 110u) << key.path;
  }
}

TEST(ConfigKeys, HaveDefaultsInsideTheirRange) {
  Config config;
  const auto loaded = load_config(dump_config(config), "defaults");
  EXPECT_TRUE(loaded) << loaded.error().message;
}

TEST(ConfigKeys, StandInTheTableOfTheDocumentation) {
  const std::string table = key_table(KeyGroup::user);
  EXPECT_THAT(table, HasSubstr("| `map.voxel_m` | `0.4` | m | 0.05 to 10 | "));
  EXPECT_THAT(table, HasSubstr("| auto \\| static \\| moving |"));
  EXPECT_THAT(table, Not(HasSubstr("`advanced.")));
  EXPECT_THAT(key_table(KeyGroup::advanced), HasSubstr("`advanced.filter.max_iterations`"));
}

TEST(ConfigKeys, AreAllInTheDefaultFile) {
  const auto project = std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
  std::ifstream file(project / "config/default.yaml");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(text, dump_config(Config{})) << "renew it: ./pllit config --dump > config/default.yaml";
}

}  // namespace
}  // namespace pllit
