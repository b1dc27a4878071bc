#include "pllit/report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "pllit/report/pictures.hpp"
#include "report/sample_visit.hpp"

namespace pllit {
namespace {

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
