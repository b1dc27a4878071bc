#include "pllit/report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "pllit/report/pictures.hpp"
#include "pllit/report/severity_file.hpp"
#include "report/sample_visit.hpp"

namespace pllit {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::ordered_json;

using test::finding;
using test::run_json;
using test::visit;

TEST(Report, SaysOnTopWhatMattersMost) {
  ReportContent content = visit();
  EXPECT_THAT(report_html(content, run_json()), HasSubstr("Nothing that was seen became abnormally hot"));
  content.anomalies = {finding(3, 40.0), finding(4, 80.0)};
  const std::string html = report_html(content, run_json());
  EXPECT_THAT(html, HasSubstr("<b>2 places</b> became abnormally hot"));
  EXPECT_LT(html.find("Finding 4"), html.find("Finding 3"));  // the worse one first
}

TEST(Report, LeavesOutWhatWasNeverAnAlarm) {
  ReportContent content = visit();
  content.anomalies = {finding(3, 40.0)};
  content.anomalies[0].confirmed.reset();
  EXPECT_THAT(report_html(content, run_json()), Not(HasSubstr("Finding 3")));
}

TEST(Report, ClaimsNoTemperatureOfGreysAndCounts) {
  ReportContent content = visit();
  content.anomalies = {finding(3, 40.0)};
  for (const IntensityUnit unit : {IntensityUnit::grey, IntensityUnit::count}) {
    content.unit = unit;
    const std::string html = report_html(content, run_json());
    EXPECT_THAT(html, Not(HasSubstr("40.0 K")));
    EXPECT_THAT(html, Not(HasSubstr("NETA")));
  }
  content.unit = IntensityUnit::kelvin;
  EXPECT_THAT(report_html(content, run_json()), HasSubstr("major: repair at once (NETA 100.18"));
}

TEST(Report, TellsDifferencesOfCountsInKelvinWhereTheUserCalibratedThem) {
  ReportContent content = visit();
  content.unit = IntensityUnit::count;
  content.anomalies = {finding(3, 120.0)};
  EXPECT_THAT(report_html(content, run_json()), Not(HasSubstr(" K<")));
  content.counts_per_kelvin = 30.0;
  const std::string html = report_html(content, run_json());
  EXPECT_THAT(html, HasSubstr("60.0 counts on average"));
  EXPECT_THAT(html, HasSubstr("about 2.0 and 4.0 K"));
  EXPECT_THAT(html, HasSubstr("30.0 counts a kelvin"));
  EXPECT_THAT(html, Not(HasSubstr("NETA"))) << "no class without a radiometric camera";
}

TEST(Report, SaysWhatWasNotSeenAndWhenItWasInDoubt) {
  ReportContent content = visit();
  content.doubts = {{1'700'000'003.0, 1'700'000'004.5, "degraded", "scan not matched: <few> points"}};
  const std::string html = report_html(content, run_json(15));
  EXPECT_THAT(html, HasSubstr("of 50 % it saw enough"));
  EXPECT_THAT(html, HasSubstr("in doubt in 15 of 100 frames"));
  EXPECT_THAT(html, HasSubstr("<td>1.5 s</td><td>degraded</td><td>scan not matched: &lt;few&gt; points</td>"));
  content.has_images = false;
  EXPECT_THAT(report_html(content, run_json()), HasSubstr("says nothing about heat"));
}

TEST(Report, DrawsHowLocalisationWentWithTheWorstOfEachMoment) {
  ReportContent content = visit();
  for (int i = 0; i < 5000; ++i)
    content.health.push_back(
        {.time_s = 1.7e9 + 0.1 * i, .state = "good", .reasons = {}, .sigma_m = 0.01, .matched = 400.0});
  EXPECT_THAT(report_html(content, run_json()), Not(HasSubstr("#c22\"/>"))) << "never lost";
  content.health[3000].state = "lost";
  content.health[3000].sigma_m = 3.5;
  const std::string html = report_html(content, run_json());
  EXPECT_THAT(html, HasSubstr("#c22\"/>")) << "one frame of five thousand";
  EXPECT_THAT(html, HasSubstr(">5</text><text")) << "the sigma's axis reaches above 3.5 m";
  EXPECT_THAT(html, HasSubstr(">500 s</text>"));
  content.health.resize(1);
  EXPECT_THAT(report_html(content, run_json()), Not(HasSubstr("<svg")));
}

TEST(Report, CarriesRecordingAndConfiguration) {
  Json run = run_json();
  run["sources"] = {"hall.bag"};
  run["config"] = "input:\n  unit: <auto>\n";
  const std::string html = report_html(visit(), run);
  EXPECT_THAT(html, HasSubstr("Recording: hall.bag"));
  EXPECT_THAT(html, HasSubstr("unit: &lt;auto&gt;"));
}

TEST(Report, NeedsNothingButItself) {
  ReportContent content = visit();
  content.anomalies = {finding(3, 40.0)};
  content.crops[3] = cv::Mat(20, 30, CV_8UC1, cv::Scalar(7));
  const std::string html = report_html(content, run_json());
  for (const char* outside : {"http://", "https://", "<script src", "<link", "import", "fetch("})
    EXPECT_THAT(html, Not(HasSubstr(outside)));
  EXPECT_THAT(html, HasSubstr("<title>Hall &lt;3&gt;</title>"));
  EXPECT_THAT(html, HasSubstr("Thermogram of finding 3"));
}

TEST(Report, CarriesAViewOfMapWayAndFindingsThatTurns) {
  ReportContent content = visit();
  content.anomalies = {finding(3, 40.0)};
  const std::string html = report_html(content, run_json());
  const std::string begin = "id=\"view3d-data\">";
  const std::size_t from = html.find(begin) + begin.size();
  const Json data = Json::parse(html.substr(from, html.find("</script>", from) - from));
  EXPECT_EQ(data["findings"], (Json{{{"id", 3}, {"position_m", {1.0, 2.0, 0.5}}}}));
  EXPECT_EQ(data["way"].size(), 20u);                                       // half a metre apart
  EXPECT_GE(data["points"].get<std::string>().size(), 7u * 98u / 3u * 4u);  // all but a few stray ones
}

TEST(Report, StandsWithNothingInIt) { EXPECT_THAT(report_html({.title = "empty"}, run_json()), HasSubstr("</html>")); }

TEST(Severity, ReachesFromItsBoundUpToTheNext) {
  const SeverityTable table = neta_100_18();
  const auto name = [&](double rise_k) {
    const auto severity = severity_of(finding(1, rise_k), IntensityUnit::kelvin, table);
    return severity ? severity->name : "";
  };
  EXPECT_EQ(name(0.99), "");
  EXPECT_EQ(name(1.0), "possible");
  EXPECT_EQ(name(3.99), "possible");
  EXPECT_EQ(name(4.0), "probable");
  EXPECT_EQ(name(14.99), "probable");
  EXPECT_EQ(name(15.0), "major");
}

std::string severity_error(const std::string& yaml) {
  const auto table = parse_severity(yaml, "mine.yaml");
  if (table) {
    ADD_FAILURE() << "read without error:\n" << yaml;
    return "";
  }
  EXPECT_EQ(table.error().kind, Error::Kind::input);
  return table.error().message;
}

TEST(SeverityFile, ThatComesWithTheProgramIsTheBuiltInTable) {
  const auto project = std::filesystem::path(__FILE__).parent_path().parent_path().parent_path();
  std::ifstream file(project / "config/severity/neta_100_18.yaml");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto table = parse_severity(text, "neta_100_18.yaml");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(*table, neta_100_18());
}

TEST(SeverityFile, GivesTheClassesOfTheReport) {
  ReportContent content = visit();
  content.unit = IntensityUnit::kelvin;
  content.anomalies = {finding(3, 40.0)};
  content.severity = parse_severity(
                         "scheme: works rule 7\nclasses:\n  - {from_K: 10, name: B, action: watch}\n"
                         "  - {from_K: 40, name: A, action: stop <at once>}\n",
                         "mine.yaml")
                         .value();
  EXPECT_THAT(report_html(content, run_json()), HasSubstr("A: stop &lt;at once&gt; (works rule 7)"));
  content.anomalies = {finding(3, 39.9)};
  EXPECT_THAT(report_html(content, run_json()), HasSubstr("B: watch (works rule 7)"));
}

TEST(SeverityFile, NamesEveryMistakeItsLineAndWhatToDo) {
  const std::string top = "scheme: mine\nclasses:\n";
  EXPECT_EQ(
      severity_error(top + "  - {from_K: 4, name: a, action: b}\n  - {from_K: 4, name: c, action: d}\n"),
      "mine.yaml:4: from_K: 4 does not exceed the 4 of the class before; list them from the mildest to the worst");
  EXPECT_THAT(severity_error(top + "  - {from_k: 4, name: a, action: b}\n"),
              AllOf(HasSubstr("mine.yaml:3: unknown key 'from_k' of a class; did you mean 'from_K'?"),
                    HasSubstr("from_K is missing")));
  EXPECT_THAT(severity_error(top + "  - {from_K: warm, name: a, action: b}\n"), HasSubstr("must be a number"));
  EXPECT_THAT(severity_error(top + "  - {from_K: -1, name: a, action: b}\n"), HasSubstr("give 0 to 2000"));
  EXPECT_THAT(severity_error(top + "  - {from_K: 1, name: a}\n"), HasSubstr("action is missing"));
  EXPECT_THAT(severity_error(top + "  - {from_K: 1, name: a, action: b}\n  - {from_K: 2, name: a, action: b}\n"),
              HasSubstr("name: 'a' is that of another class too"));
  EXPECT_THAT(severity_error("scheme: mine\nclasses: []\n"), HasSubstr("must be a list with at least one"));
  EXPECT_THAT(severity_error("classes:\n  - {from_K: 1, name: a, action: b}\n"), HasSubstr("scheme is missing"));
  EXPECT_THAT(severity_error("- 1\n"), HasSubstr("the file must hold keys (scheme, classes)"));
  EXPECT_THAT(severity_error(""), HasSubstr("mine.yaml:1"));
}

TEST(Report, SaysWhatTemperaturesWereCorrectedFor) {
  ReportContent content = visit();
  content.unit = IntensityUnit::kelvin;
  content.anomalies = {finding(3, 40.0)};
  EXPECT_THAT(report_html(content, run_json()), HasSubstr("apparent temperature; emissivity and reflections not"));
  content.radiometry = {.emissivity = 0.85, .reflected_K = 291.0, .air_K = 288.0, .absorbed_per_m = 0.004};
  EXPECT_THAT(report_html(content, run_json()),
              AllOf(HasSubstr("corrected for an emissivity of 0.85 and surroundings of 291.0 K, and for air of 288.0 K "
                              "that absorbs 0.4 % a metre"),
                    Not(HasSubstr("apparent temperature"))));
}

TEST(Plan, ShowsHotterSurfacesBrighter) {
  const ReportContent content = visit();
  const cv::Mat picture = plan_of(content.thermal_map, content.trajectory, {});
  ASSERT_FALSE(picture.empty());
  cv::Mat seen = picture(cv::Rect(0, 0, picture.cols, picture.rows / 2));  // the wall lies beyond the way
  const auto brightness = [&](const cv::Mat& part) {
    cv::Mat marked;
    cv::inRange(part, cv::Scalar::all(28), cv::Scalar::all(28), marked);
    return cv::sum(cv::mean(part, 255 - marked))[0];
  };
  EXPECT_GT(brightness(seen.colRange(3 * seen.cols / 4, seen.cols)), brightness(seen.colRange(0, seen.cols / 4)));
}

}  // namespace
}  // namespace pllit
