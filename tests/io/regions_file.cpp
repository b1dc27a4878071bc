#include "pllit/io/regions_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "pllit/io/file.hpp"
#include "support/temporary_folder.hpp"

namespace pllit {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string error_of(const std::string& yaml) {
  const auto regions = parse_regions(yaml, "hall.yaml");
  if (regions) {
    ADD_FAILURE() << "read without error:\n" << yaml;
    return "";
  }
  EXPECT_EQ(regions.error().kind, Error::Kind::input);
  return regions.error().message;
}

const std::string kBox = "box_m: {min: [1, 2, 0], max: [2, 3, 1.5]}";

TEST(RegionsFile, GivesWhatItSays) {
  const auto regions = parse_regions(
      "regions:\n"
      "  - tag: pump-3\n"
      "    box_m: {min: [1, -2, 0], max: [2, +3, 1.5]}\n"
      "    yaw_deg: 30\n"
      "    emissivity: 0.92\n"
      "    limits: {change: 12.5, kelvin: 330}\n"
      "  - {tag: Schrank Süd, " +
          kBox + "}\n",
      "hall.yaml");
  ASSERT_TRUE(regions) << regions.error().message;
  ASSERT_EQ(regions->size(), 2u);
  const Region& pump = regions->front();
  EXPECT_EQ(pump.tag, "pump-3");
  EXPECT_EQ(pump.min_W, Vector3d(1.0, -2.0, 0.0));
  EXPECT_EQ(pump.max_W, Vector3d(2.0, 3.0, 1.5));
  EXPECT_NEAR(pump.yaw_rad, std::numbers::pi / 6.0, 1e-12);
  EXPECT_EQ(pump.emissivity, 0.92);
  EXPECT_EQ(pump.limits.change, 12.5);
  EXPECT_EQ(pump.limits.kelvin, 330.0);
  EXPECT_EQ(pump.line, 2);
  EXPECT_EQ((*regions)[1].tag, "Schrank Süd");
  EXPECT_EQ((*regions)[1].line, 7);
  EXPECT_FALSE((*regions)[1].emissivity || (*regions)[1].limits.change || (*regions)[1].limits.kelvin);
}

TEST(RegionsFile, IsAsTheDocumentationShowsIt) {
  const auto project = std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
  const std::string text = read_file(project / "docs/ANOMALIES.md").value();
  const auto begin = text.find("```yaml\n") + 8;
  const auto regions = parse_regions(text.substr(begin, text.find("```", begin) - begin), "docs/ANOMALIES.md");
  ASSERT_TRUE(regions) << regions.error().message;
  EXPECT_EQ(regions->size(), 2u);
}

TEST(RegionsFile, NamesAnUnknownKeyItsLineAndTheNearestKnownOne) {
  EXPECT_EQ(error_of("regions:\n  - tag: a\n    " + kBox + "\n    emisivity: 0.9\n"),
            "hall.yaml:4: unknown key 'emisivity' of a region; did you mean 'emissivity'?");
  EXPECT_THAT(error_of("regoins: []"),
              HasSubstr("hall.yaml:1: unknown key 'regoins' of the file; did you mean 'regions'?"));
  EXPECT_THAT(error_of("regions:\n  - {tag: a, " + kBox + ", limits: {chnage: 3}}"),
              HasSubstr("did you mean 'change'?"));
  EXPECT_THAT(error_of("regions:\n  - {tag: a, box_m: {min: [0, 0, 0], mx: [1, 1, 1]}}"),
              AllOf(HasSubstr("did you mean 'max'?"), HasSubstr("box_m has no max")));
}

TEST(RegionsFile, RefusesATagThatTwoRegionsBear) {
  EXPECT_EQ(error_of("regions:\n  - {tag: a, " + kBox + "}\n  - {tag: b, " + kBox + "}\n  - {tag: a, " + kBox + "}\n"),
            "hall.yaml:4: tag 'a' is that of the region in line 2 too; each needs its own");
}

TEST(RegionsFile, RefusesBoxesThatHoldNothing) {
  EXPECT_THAT(error_of("regions:\n  - tag: a\n    box_m: {min: [0, 2, 0], max: [1, 1, 1]}\n"),
              AllOf(HasSubstr("hall.yaml:3: box_m: along y it reaches from 2 to 1"), Not(HasSubstr("along x"))));
  EXPECT_THAT(error_of("regions:\n  - {tag: a, box_m: {min: [0, 0, 0], max: [1, 1, 0]}}"), HasSubstr("along z"));
  EXPECT_THAT(error_of("regions:\n  - {tag: a}"), HasSubstr("hall.yaml:2: the region has no box"));
}

TEST(RegionsFile, RefusesValuesOfTheWrongKind) {
  const auto with = [&](const std::string& more) { return error_of("regions:\n  - {tag: a, " + more + "}"); };
  EXPECT_THAT(with("box_m: [0, 1]"), HasSubstr("box_m must hold keys (min, max), but is a list of 2"));
  EXPECT_THAT(with("box_m: {min: [0, 0], max: [1, 1, 1]}"), HasSubstr("box_m.min must be a list of 3 numbers"));
  EXPECT_THAT(with("box_m: {min: [0, 0, low], max: [1, 1, 1]}"),
              HasSubstr("box_m.min: number 3: must be a number, but is 'low'"));
  EXPECT_THAT(with("box_m: {min: [0, 0, nan], max: [1, 1, 1]}"), HasSubstr("not a finite number"));
  EXPECT_THAT(with(kBox + ", emissivity: 1.2"), HasSubstr("emissivity: 1.2 is out of range; give 0.05 to 1"));
  EXPECT_THAT(with(kBox + ", limits: 5"), HasSubstr("limits must hold keys (change, kelvin), but is '5'"));
  EXPECT_THAT(with(kBox + ", limits: {change: -3}"), HasSubstr("change: -3 is out of range"));
  EXPECT_THAT(error_of("regions:\n  - {" + kBox + "}"), HasSubstr("the region has no tag"));
  EXPECT_THAT(error_of("regions:\n  - {tag: [1], " + kBox + "}"), HasSubstr("tag: must be a text"));
  EXPECT_THAT(error_of("regions:\n  - {tag: \"\", " + kBox + "}"), HasSubstr("is no name"));
  EXPECT_THAT(error_of("regions:\n  - pump"), HasSubstr("a region must hold keys"));
}

TEST(RegionsFile, RefusesWhatIsNoListOfRegions) {
  EXPECT_THAT(error_of(""), HasSubstr("hall.yaml:1: the file must hold keys (regions), but is empty"));
  EXPECT_THAT(error_of("regions: []"), HasSubstr("must be a list with at least one"));
  EXPECT_THAT(error_of("regions:\n  - {tag: a\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(error_of("regions: &a\n  - *a\n"), HasSubstr("a region must hold keys"));
}

TEST(RegionsFile, ListsAllMistakesAtOnce) {
  EXPECT_THAT(error_of("regions:\n  - {tag: a}\n  - {" + kBox + "}\n  - {tag: c, " + kBox + ", yaw: 3}\n"),
              AllOf(HasSubstr("hall.yaml:2:"), HasSubstr("\nhall.yaml:3:"), HasSubstr("\nhall.yaml:4:")));
}

TEST(RegionsFile, AsksForTemperaturesOnlyOfMapsThatHoldThem) {
  const auto regions = parse_regions("regions:\n  - {tag: a, " + kBox + ", emissivity: 0.9}\n  - {tag: b, " + kBox +
                                         ", limits: {kelvin: 330, change: 2}}\n",
                                     "hall.yaml")
                           .value();
  EXPECT_TRUE(check_unit(regions, IntensityUnit::kelvin, "hall.yaml"));
  const auto refused = check_unit(regions, IntensityUnit::grey, "hall.yaml");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              AllOf(HasSubstr("hall.yaml:2: emissivity of 'a' needs temperatures, and these visits are in grey"),
                    HasSubstr("\nhall.yaml:3: limits.kelvin of 'b'"), HasSubstr("take it out")));
}

TEST(RegionsFile, IsReadFromTheDisk) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(read_regions(folder / "none.yaml").error().message, HasSubstr("none.yaml: no such file"));
  ASSERT_TRUE(write_file(folder / "hall.yaml", "regions:\n  - {tag: a, " + kBox + "}\n"));
  EXPECT_EQ(read_regions(folder / "hall.yaml").value().front().tag, "a");
}

TEST(RegionsFile, DefinesARegionByWhatItsReadingsDependOn) {
  const auto definition = [](const std::string& more) {
    return definition_of(parse_regions("regions:\n  - {tag: a, " + kBox + more + "}", "hall.yaml").value().front());
  };
  EXPECT_EQ(definition(""), "[1, 2, 0] to [2, 3, 1.5] m");
  EXPECT_EQ(definition(", limits: {change: 3}"), definition(""));
  EXPECT_NE(definition(", yaw_deg: 10"), definition(""));
  EXPECT_NE(definition(", emissivity: 0.5"), definition(""));
}

}  // namespace
}  // namespace pllit
