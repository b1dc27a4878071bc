#include "run_program.hpp"

namespace pllit {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class ConfigVerb : public test::ProgramTest {};

TEST_F(ConfigVerb, DumpsWhatItReadsBack) {
  for (const char* preset : {"default", "kitti", "hilti2022", "ntu4dradlm"}) {
    const auto dumped = run({"config", "--dump", preset});
    EXPECT_EQ(dumped.exit_code, 0) << dumped.err;
    EXPECT_THAT(dumped.err, IsEmpty());
    const auto again = run({"config", "--dump", write("dump.yaml", dumped.out)});
    EXPECT_EQ(again.out, dumped.out) << preset;
  }
}

TEST_F(ConfigVerb, DumpsTheDefaultsWithoutAName) {
  EXPECT_EQ(run({"config", "--dump"}).out, run({"config", "--dump", "default"}).out);
}

TEST_F(ConfigVerb, AppliesSettingsInOrder) {
  const auto [exit_code, out, err] = run({"config", "--dump", "kitti", "--set", "map.voxel_m=1", "--set",
                                          "map.voxel_m=0.125", "--set", "rig.lidar.range_m=[1, 60]"});
  EXPECT_EQ(exit_code, 0) << err;
  EXPECT_THAT(out, AllOf(HasSubstr("voxel_m: 0.125\n"), HasSubstr("range_m: [1, 60]\n"), HasSubstr("mode: moving\n")));
}

TEST_F(ConfigVerb, RefusesWrongConfigurationsWithExitCodeTwo) {
  const std::string file = write("wrong.yaml", "map:\n  voxl_m: 1\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"config", "--dump", file}, file + ":2: unknown key 'map.voxl_m'; did you mean 'map.voxel_m'?"},
      {{"config", "--dump", "kiti"}, "did you mean 'kitti'?"},
      {{"config", "--dump", "--set", "map.voxel_m=-1"}, "-1 is out of range"},
      {{"config", "--dump", "--set", "rig.lidar.range_m=[5, 1]"}, "keeps no point"}};
  for (const auto& [arguments, message] : cases) {
    const auto [exit_code, out, err] = run(arguments);
    EXPECT_EQ(exit_code, 2) << err;
    EXPECT_THAT(out, IsEmpty());
    EXPECT_THAT(err, HasSubstr(message));
  }
}

TEST_F(ConfigVerb, ListsPresetsAndKeys) {
  const auto presets = run({"config", "--presets"});
  EXPECT_EQ(presets.exit_code, 0);
  EXPECT_THAT(presets.out, AllOf(HasSubstr("kitti"), HasSubstr("Velodyne HDL-64"), HasSubstr("hilti2022")));
  const auto keys = run({"config", "--keys"});
  EXPECT_EQ(keys.exit_code, 0);
  EXPECT_THAT(keys.out, AllOf(HasSubstr("| `map.voxel_m` |"), HasSubstr("| `advanced.filter.max_iterations` |")));
}

}  // namespace
}  // namespace pllit
