// pllit compare and pllit trends on two visits to a made-up site.
#include <cmath>
#include <format>
#include <nlohmann/json.hpp>

#include "pllit/io/anomalies_file.hpp"
#include "pllit/io/file.hpp"
#include "pllit/io/session.hpp"
#include "run_program.hpp"
#include "support/walled_site.hpp"

namespace pllit {
namespace {

using test::Random;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using Json = nlohmann::json;
namespace fs = std::filesystem;

struct SimpleVisit {
  std::string name;
  int day = 0;
  double pump = 150.0;            ///< grey
  double gain = 1.0, bias = 0.0;  ///< of all greys
  SE3 T_B_A = SE3::Identity();    ///< from the site's frame to the visit's
  IntensityUnit unit = IntensityUnit::grey;
};

/// Six metres by three of a wall with bricks from cool to hot at y = 3 m, and a pump of 0.6 m in its middle, about as
/// bright as the hottest of them.
PointTable heat_of(const SimpleVisit& visit) {
  PointTable table{.points = {}, .fields = {{"intensity", {}}, {"normal", {}}, {"sigma", {}}, {"images", {}}}};
  for (int i = 0; i < 120; ++i)
    for (int k = 0; k < 60; ++k) {
      const bool pump = std::abs(i - 60) < 6 && std::abs(k - 30) < 6;
      const double value = visit.gain * (pump ? visit.pump : 80.0 + 30.0 * ((i / 8 + k / 8) % 4)) + visit.bias;
      table.points.emplace_back(0.05F * static_cast<float>(i) - 3.0F, 3.0F, 0.05F * static_cast<float>(k));
      for (const int field : {0, 1}) table.fields[field].values.push_back(static_cast<float>(value));
      table.fields[2].values.push_back(4.0F);
      table.fields[3].values.push_back(20.0F);
    }
  return table;
}

class CompareVerb : public test::ProgramTest {
 protected:
  std::string session(const SimpleVisit& visit) const {
    const std::string folder = path(visit.name);
    auto writer = SessionWriter::create(folder, {.health_columns = {"time_s"}, .map_fields = {}}).value();
    for (int i = 0; i <= 100; ++i)
      EXPECT_TRUE(writer.append_pose(
          {time_from_parts(1'700'000'000, 0) + std::chrono::days(visit.day) + std::chrono::milliseconds(100 * i),
           visit.T_B_A * pose_from(SO3::Identity(), {-10.0 + 0.2 * i, 0.0, 1.5})}));
    Random noise(static_cast<unsigned>(10 + visit.day));
    EXPECT_TRUE(writer.append_map({moved(test::walled_site(1, noise), visit.T_B_A), {}}));
    PointTable heat = heat_of(visit);
    heat.points = moved(heat.points, visit.T_B_A);
    EXPECT_TRUE(writer.write_cloud("thermal_map.ply", heat));
    EXPECT_TRUE(writer.write_text("anomalies.json", anomalies_json({}, visit.unit).dump()));
    EXPECT_TRUE(writer.write_run({{"sources", {std::format("/data/{}.bag", visit.name)}}, {"program", "pllit test"}}));
    return folder;
  }
  std::string regions(const std::string& more = "") const {
    return write("hall.yaml",
                 "regions:\n"
                 "  - tag: pump\n    box_m: {min: [-0.3, 2.8, 1.2], max: [0.3, 3.2, 1.8]}\n    limits: {change: 25}\n"
                 "  - {tag: yard, box_m: {min: [9, 9, 0], max: [10, 10, 3]}}\n" +
                     more);
  }
  static std::vector<Vector3f> moved(std::vector<Vector3f> points, const SE3& T) {
    for (Vector3f& p : points) p = T.act(p.cast<double>()).cast<float>();
    return points;
  }

  const SE3 T_B_A_ = pose_from(exp_so3(Vector3d(0.0, 0.0, 0.9)), Vector3d(7.0, -3.0, 0.5));
};

TEST_F(CompareVerb, ReadsNamedRegionsOfALaterVisitInTheBaselinesFrameAndScale) {
  const std::string monday = session({.name = "monday"});
  const std::string friday =
      session({.name = "friday", .day = 4, .pump = 185.0, .gain = 0.8, .bias = 20.0, .T_B_A = T_B_A_});
  const auto [exit_code, out, err] = run({"compare", monday, friday, "--regions", regions(), "--json"});
  ASSERT_EQ(exit_code, 0) << err;
  EXPECT_THAT(err, HasSubstr("hall.yaml:5: the baseline saw nothing in the box of 'yard'"));
  const Json json = Json::parse(out);
  EXPECT_EQ(json["regions"]["unit"], "grey");
  EXPECT_NEAR(json["regions"]["baseline"][0]["intensity"]["mean"].get<double>(), 150.0,
              12.0);  // its rim holds some wall
  const Json& pump = json["sessions"][0]["regions"][0];
  EXPECT_EQ(pump["tag"], "pump");
  EXPECT_GT(pump["voxels"]["share"].get<double>(), 0.6);
  EXPECT_NEAR(pump["intensity"]["max"].get<double>(), 185.0, 10.0);
  EXPECT_NEAR(pump["own"]["max"].get<double>(), 0.8 * 185.0 + 20.0, 4.0);
  EXPECT_GT(pump["change"]["mean"].get<double>(), 20.0);
  EXPECT_EQ(pump["exceeded"]["change"], true);
  const Json& yard = json["sessions"][0]["regions"][1];
  EXPECT_EQ(yard["seen"], false);
  EXPECT_TRUE(yard["intensity"].is_null());
  const auto alarm = run({"compare", monday, friday, "--regions", path("hall.yaml"), "--alarm-exit"});
  EXPECT_EQ(alarm.exit_code, 4) << alarm.err;
  EXPECT_THAT(alarm.out, AllOf(HasSubstr("  region pump: seen"), HasSubstr("LIMIT EXCEEDED"),
                               HasSubstr("  region yard: not seen")));
}

TEST_F(CompareVerb, FillsAStoreThatTrendsShows) {
  const std::string monday = session({.name = "monday"}), store = path("hall.sqlite");
  std::vector<std::string> compare{"compare", monday};
  for (const int day : {1, 2, 3})
    compare.push_back(session({.name = std::format("day{}", day), .day = day, .pump = 150.0 + 6.0 * day}));
  for (const std::string& more : {std::string("--regions"), regions(), std::string("--store"), store})
    compare.push_back(more);
  for (int again = 0; again < 2; ++again) {
    const auto compared = run(compare);
    ASSERT_EQ(compared.exit_code, 0) << compared.err;
  }
  const auto [exit_code, out, err] = run({"trends", store, "--json"});
  ASSERT_EQ(exit_code, 0) << err;
  const Json json = Json::parse(out);
  ASSERT_EQ(json["regions"].size(), 2u);
  const Json& pump = json["regions"][0];
  ASSERT_EQ(pump["visits"].size(), 4u) << "a visit that is compared again is replaced";
  EXPECT_EQ(pump["visits"][1]["time_utc"], "2023-11-15T22:13:20Z");
  EXPECT_NEAR(pump["trend"]["p95"]["per_day"].get<double>(), 6.0, 1.0);
  EXPECT_GT(pump["trend"]["change"]["per_day"].get<double>(), 4.0);
  EXPECT_TRUE(json["regions"][1]["trend"]["change"].is_null());
  const auto text = run({"trends", store, "--tag", "pump"});
  EXPECT_THAT(text.out, AllOf(HasSubstr("  2023-11-17T22:13:20Z  seen"), HasSubstr("  trend of its change: +"),
                              Not(HasSubstr("yard"))));
  const auto mistyped = run({"trends", store, "--tag", "pmup"});
  EXPECT_EQ(mistyped.exit_code, 2);
  EXPECT_THAT(mistyped.err, HasSubstr("holds no region 'pmup'; did you mean 'pump'?"));
}

TEST_F(CompareVerb, RefusesBeforeItComparesWhatCannotBeRight) {
  const std::string monday = session({.name = "monday"}), friday = session({.name = "friday", .day = 4});
  const auto refused = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"compare", monday, friday};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto [exit_code, out, err] = run(arguments);
    EXPECT_EQ(exit_code, 2);
    EXPECT_THAT(out, IsEmpty());
    return err;
  };
  EXPECT_THAT(refused({"--store", path("hall.sqlite")}), HasSubstr("--regions"));
  EXPECT_THAT(refused({"--regions", ""}), HasSubstr("The value of --regions is empty"));
  EXPECT_THAT(refused({"--regions", path("none.yaml")}), HasSubstr("none.yaml: no such file"));
  EXPECT_THAT(refused({"--regions", write("bad.yaml", "regions:\n  - {tag: a, bxo_m: 3}\n")}),
              HasSubstr("did you mean 'box_m'?"));
  EXPECT_THAT(
      refused({"--regions", regions("  - {tag: hot, box_m: {min: [0, 0, 0], max: [1, 1, 1]}, emissivity: 0.9}\n")}),
      HasSubstr("emissivity of 'hot' needs temperatures"));
  EXPECT_THAT(refused({"--regions", regions(), "--store", write("notes.txt", std::string(2000, 'n'))}),
              HasSubstr("is no SQLite file"));
  EXPECT_THAT(run({"trends", path("none.sqlite")}).err, HasSubstr("none.sqlite: no such file"));
}

TEST_F(CompareVerb, ComparesNoGreysWithTemperatures) {
  const std::string monday = session({.name = "monday"});
  const std::string friday = session({.name = "friday", .day = 4, .unit = IntensityUnit::count});
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--regions", regions()}}) {
    std::vector<std::string> words{"compare", monday, friday};
    words.insert(words.end(), more.begin(), more.end());
    const auto [exit_code, out, err] = run(words);
    EXPECT_EQ(exit_code, 2);
    EXPECT_THAT(err, HasSubstr("is in count, but the baseline"));
  }
}

}  // namespace
}  // namespace pllit
