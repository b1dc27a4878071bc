#include <gmock/gmock.h>

#include "config_support.hpp"

namespace pllit {
namespace {

using test::load_error;
using testing::AllOf;
using testing::HasSubstr;

TEST(ConfigLoading, TakesTheDefaultsWhereTheTextSaysNothing) {
  for (const char* text : {"", "# nothing\n", "map:\n", "---\n"}) {
    const auto config = load_config(text, "my.yaml");
    ASSERT_TRUE(config) << config.error().message;
    EXPECT_EQ(*config, Config{}) << text;
  }
}

TEST(ConfigLoading, ReadsEveryKindOfValue) {
  const auto config = load_config(R"(
input: {imu_topic: /imu, lidar_time_unit: us, accel_unit: g}
rig:
  lidar:
    T_I_L: {translation_m: [1, -2, +3.5], rotation_xyzw: [0, 0, 0, 1]}
    range_m: [1, 2e1]
  camera:
    size_px: [640, 512]
    intrinsics_px: [500, 501, 320, 256]
    model: equidistant
start: {mode: static}
threads: 3
advanced:
  gaps: {max_gap_s: 0.125}
)",
                                  "my.yaml");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->input.imu_topic, "/imu");
  EXPECT_EQ(config->input.lidar_time_unit, PointTimeUnit::us);
  EXPECT_EQ(config->start.unit, AccelUnit::g);
  EXPECT_EQ(config->start.mode, StartMode::still);
  EXPECT_EQ(config->rig.lidar.T_I_L.translation_m, (std::array{1.0, -2.0, 3.5}));
  EXPECT_EQ(config->rig.lidar.range_m, (std::array{1.0, 20.0}));
  EXPECT_EQ(config->rig.camera.size_px, (std::array{640, 512}));
  EXPECT_EQ(config->rig.camera.model, Camera::Distortion::equidistant);
  EXPECT_EQ(config->threads, 3);
  EXPECT_EQ(config->gaps.max_gap, std::chrono::milliseconds(125));
  EXPECT_EQ(config->map.voxel_m, Config{}.map.voxel_m);
}

TEST(ConfigLoading, ReadsAPoseFromA4x4Matrix) {
  const auto config =
      load_config("rig: {lidar: {T_I_L: [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]}}", "my.yaml");
  ASSERT_TRUE(config) << config.error().message;
  const SE3 T_I_L = make_rig(config->rig).T_I_L;
  EXPECT_NEAR((T_I_L.act(Vector3d::UnitX()) - Vector3d(1.0, 3.0, 3.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((T_I_L.act(Vector3d::UnitZ()) - Vector3d(1.0, 2.0, 4.0)).norm(), 0.0, 1e-12);
}

TEST(ConfigLoading, NamesAnUnknownKeyItsLineAndTheNearestKnownOne) {
  EXPECT_EQ(load_error("input:\n  imu_topic: /imu\nmap:\n  voxl_m: 0.3\n"),
            "my.yaml:4: unknown key 'map.voxl_m'; did you mean 'map.voxel_m'?");
  EXPECT_EQ(load_error("mpa:\n  voxel_m: 0.3\n"), "my.yaml:1: unknown key 'mpa'; did you mean 'map'?");
}

TEST(ConfigLoading, FindsAKeyThatWasWrittenInTheWrongSection) {
  EXPECT_THAT(load_error("voxel_m: 0.3\n"), HasSubstr("did you mean 'map.voxel_m'?"));
  EXPECT_THAT(load_error("rig:\n  T_I_L: 1\n"), HasSubstr("did you mean 'rig.lidar.T_I_L'?"));
  EXPECT_THAT(load_error("filter:\n  max_iterations: 2\n"), HasSubstr("did you mean 'advanced.filter'?"));
}

TEST(ConfigLoading, RefusesValuesOfTheWrongKind) {
  EXPECT_EQ(load_error("map:\n  voxel_m: big\n"), "my.yaml:2: map.voxel_m: must be a number, but is 'big'");
  EXPECT_EQ(load_error("threads: 2.5"), "my.yaml:1: threads: must be a whole number, but is '2.5'");
  EXPECT_EQ(load_error("threads: [2]"), "my.yaml:1: threads: must be a whole number, but is a list of 1");
  EXPECT_EQ(load_error("threads:"), "my.yaml:1: threads: must be a whole number, but is empty");
  EXPECT_THAT(load_error("start: {mode: fast}"),
              HasSubstr("start.mode: must be auto | static | moving, but is 'fast'"));
  EXPECT_THAT(load_error("input: {imu_topic: [a]}"), HasSubstr("must be a text, but is a list of 1"));
  EXPECT_THAT(load_error("input: {imu_topic: 'a b'}"), HasSubstr("'a b' has spaces"));
  EXPECT_THAT(load_error("rig: {lidar: {range_m: [1, 2, 3]}}"),
              HasSubstr("must be a list of 2 numbers, but is a list of 3"));
  EXPECT_THAT(load_error("rig: {lidar: {range_m: [1, far]}}"), HasSubstr("number 2: must be a number, but is 'far'"));
  EXPECT_THAT(load_error("map: 3"), HasSubstr("map is a section: put its keys below it"));
  EXPECT_THAT(load_error("map: [1]"), HasSubstr("map is a section"));
  EXPECT_THAT(load_error("just words"), HasSubstr("my.yaml:1: expected 'section:' lines"));
  EXPECT_THAT(load_error("[1, 2]: 3"), HasSubstr("a key must be a single word"));
}

TEST(ConfigLoading, RefusesNumbersOutOfRangeAndNotFinite) {
  EXPECT_EQ(load_error("map:\n  voxel_m: 0"), "my.yaml:2: map.voxel_m: 0 is out of range; give 0.05 to 10");
  EXPECT_THAT(load_error("map: {voxel_m: nan}"), HasSubstr("nan is not a finite number"));
  EXPECT_THAT(load_error("map: {voxel_m: inf}"), HasSubstr("inf is not a finite number"));
  EXPECT_THAT(load_error("map: {voxel_m: .nan}"), HasSubstr("must be a number, but is '.nan'"));
  EXPECT_THAT(load_error("map: {voxel_m: 1e999}"), HasSubstr("too large or too small"));
  EXPECT_THAT(load_error("threads: 99999999999"), HasSubstr("too large or too small"));
  EXPECT_THAT(load_error("threads: -1"), HasSubstr("give 0 to 256"));
}

TEST(ConfigLoading, RefusesPosesThatAreNone) {
  const auto pose = [](std::string_view value) {
    return load_error("rig: {lidar: {T_I_L: " + std::string(value) + "}}");
  };
  EXPECT_THAT(pose("{translation_m: [0, 0, 0], rotation_xyzw: [0, 0, 1, 1]}"),
              HasSubstr("not a unit quaternion: its length is 1.41421"));
  EXPECT_THAT(pose("{translation_m: [0, 0, 0], rotation_xyzw: [0, 0, 0, 0]}"), HasSubstr("its length is 0"));
  EXPECT_THAT(pose("{translation_m: [0, 0], rotation_xyzw: [0, 0, 0, 1]}"),
              HasSubstr("translation_m must be a list of 3"));
  EXPECT_THAT(pose("{translation_m: [0, 0, 0]}"), HasSubstr("must hold translation_m"));
  EXPECT_THAT(pose("[0, 0, 0]"), HasSubstr("or be a 4x4 matrix"));
  EXPECT_THAT(pose("[[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"), HasSubstr("not a rotation"));
  EXPECT_THAT(pose("[[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"), HasSubstr("not a rotation"));
  EXPECT_THAT(pose("[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [1, 2, 3, 1]]"), HasSubstr("last row"));
  EXPECT_THAT(pose("[[1, 0, 0, 0], [0, 1, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"), HasSubstr("row 2: must be a list of 4"));
}

TEST(ConfigLoading, RefusesAKeyGivenTwice) {
  EXPECT_EQ(load_error("threads: 1\nmap: {}\nthreads: 2\n"), "my.yaml:3: 'threads' is given twice");
  EXPECT_THAT(load_error("map:\n  voxel_m: 1\nmap:\n  radius_m: 50\n"), HasSubstr("my.yaml:3: 'map' is given twice"));
}

TEST(ConfigLoading, ListsAllMistakesAtOnce) {
  EXPECT_THAT(
      load_error("threads: many\nmap:\n  voxel_m: 99\n  colour: red\n"),
      AllOf(HasSubstr("my.yaml:1: threads"), HasSubstr("\nmy.yaml:3: map.voxel_m"), HasSubstr("\nmy.yaml:4: unknown")));
}

TEST(ConfigLoading, ChecksWhatSpansSeveralKeys) {
  EXPECT_THAT(load_error("rig: {lidar: {range_m: [10, 1]}}"),
              HasSubstr("my.yaml: rig.lidar.range_m: [10, 1] keeps no point"));
  EXPECT_THAT(load_error("rig: {camera: {size_px: [640, 0]}}"), HasSubstr("[640, 0] is no image"));
  EXPECT_THAT(load_error("rig: {camera: {size_px: [640, 512]}}"), HasSubstr("focal lengths 0 and 0 are not positive"));
  EXPECT_THAT(load_error("rig: {camera: {size_px: [640, 512], intrinsics_px: [500, 320, 900, 256]}}"),
              HasSubstr("lies outside the 640x512 image"));
  EXPECT_THAT(
      load_error("advanced: {radiometry: {emissivity: 0.9}}"),
      HasSubstr("my.yaml: advanced.radiometry corrects temperatures, but advanced.anomalies.unit is not kelvin"));
}

TEST(ConfigLoading, NamesTheLineOfBrokenYaml) {
  EXPECT_THAT(load_error("threads: 1\nmap: {voxel_m: 1\n"), AllOf(HasSubstr("my.yaml:"), HasSubstr("not valid YAML")));
  EXPECT_THAT(load_error("threads: 1\nmap: voxel_m: 1\n"), HasSubstr("my.yaml:2: not valid YAML"));
  EXPECT_THAT(load_error("threads: 1\n---\nthreads: 2\n"), HasSubstr("more text follows"));
}

TEST(ConfigLoading, EndsOnAStrayBracketThatTheParserNeverConsumes) {
  EXPECT_THAT(load_error(",?p: *a}\n"), HasSubstr("my.yaml"));
  EXPECT_THAT(load_error("[1]]\n"), HasSubstr("my.yaml"));
}

TEST(ConfigLoading, SurvivesDeepNestingCyclesAndHugeText) {
  for (const std::string opening : {"[", "{a: ", "- ", "? ", "a: ["}) {
    std::string text;
    while (text.size() < 200'000) text += opening;
    EXPECT_THAT(load_error(text), HasSubstr("my.yaml:1")) << opening;
  }
  EXPECT_THAT(load_error("&a {map: *a}"), HasSubstr("unknown key 'map.map'"));
  EXPECT_THAT(load_error(std::string(1 << 20, '#')), HasSubstr("1048576 bytes are too many"));
}

TEST(ConfigLoading, ShowsForeignTextShortAndPrintable) {
  const std::string message = load_error("threads: \"" + std::string(5000, 'x') + "\\e[31m\"");
  EXPECT_LT(message.size(), 200u);
  EXPECT_THAT(load_error("threads: \"\\e[31m\""), HasSubstr("'?[31m'"));
}

}  // namespace
}  // namespace pllit
