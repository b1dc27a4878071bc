#include <gmock/gmock.h>

#include "config_support.hpp"
#include "pllit/slam/config_value.hpp"

namespace pllit {
namespace {

using testing::HasSubstr;

std::string setting_error(std::string_view setting) {
  const auto config = apply_setting(Config{}, setting);
  EXPECT_FALSE(config) << setting;
  return config ? "" : config.error().message;
}

TEST(ConfigSetting, ChangesOneKeyAndNoOther) {
  const auto config = apply_setting(Config{}, "map.voxel_m=0.25");
  ASSERT_TRUE(config) << config.error().message;
  Config expected;
  expected.map.voxel_m = 0.25;
  EXPECT_EQ(*config, expected);
}

TEST(ConfigSetting, TakesListsPosesWordsAndTexts) {
  Config config;
  for (const char* setting :
       {"rig.lidar.range_m=[1, 80]", "start.mode=moving", "input.imu_topic=/a=b", "advanced.gaps.max_gap_s=0.5",
        "rig.camera.T_I_C={translation_m: [1, 2, 3], rotation_xyzw: [1, 0, 0, 0]}"}) {
    const auto changed = apply_setting(config, setting);
    ASSERT_TRUE(changed) << changed.error().message;
    config = *changed;
  }
  EXPECT_EQ(config.rig.lidar.range_m, (std::array{1.0, 80.0}));
  EXPECT_EQ(config.start.mode, StartMode::moving);
  EXPECT_EQ(config.input.imu_topic, "/a=b");
  EXPECT_EQ(config.gaps.max_gap, std::chrono::milliseconds(500));
  EXPECT_EQ(config.rig.camera.T_I_C.rotation_xyzw, (std::array{1.0, 0.0, 0.0, 0.0}));
}

TEST(ConfigSetting, ReproducesAnyConfigurationKeyByKey) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Config wanted = test::random_config(seed), config;
    for (const Key& key : keys_of(wanted).keys) {
      const bool is_text = std::holds_alternative<std::string*>(key.value);
      const std::string text = is_text ? *std::get<std::string*>(key.value) : value_text(key.value);
      const auto changed = apply_setting(config, key.path + "=" + text);
      ASSERT_TRUE(changed) << changed.error().message;
      config = *changed;
    }
    EXPECT_EQ(config, wanted) << "seed " << seed;
  }
}

TEST(ConfigSetting, ExplainsWhatIsWrong) {
  EXPECT_EQ(setting_error("map.voxl_m=1"),
            "setting 'map.voxl_m=1': unknown key 'map.voxl_m'; did you mean 'map.voxel_m'?");
  EXPECT_EQ(setting_error("map.voxel_m=0"), "setting 'map.voxel_m=0': 0 is out of range; give 0.05 to 10");
  EXPECT_THAT(setting_error("map.voxel_m"), HasSubstr("write KEY=VALUE"));
  EXPECT_THAT(setting_error("map=1"), HasSubstr("unknown key 'map'"));
  EXPECT_THAT(setting_error("rig.lidar.range_m=[1"), HasSubstr("not valid YAML"));
  EXPECT_THAT(setting_error("map.voxel_m="), HasSubstr("must be a number, but is empty"));
}

}  // namespace
}  // namespace pllit
