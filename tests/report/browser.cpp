// The page in a real browser, without a network.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <string>

#include "report/sample_visit.hpp"
#include "support/temporary_folder.hpp"

namespace pllit {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string read(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// What a page has become once its scripts have run, and what the browser's console said.
struct Shown {
  int status = -1;
  std::string page, console;
};

Shown shown(const std::string& html) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "report.html", std::ios::binary) << html;
  const auto quoted = [&](const char* name) { return "'" + (folder / name).string() + "'"; };
  const std::string command =
      "unshare -n true 2>/dev/null && offline='unshare -n' || offline=; $offline timeout 100 chromium --headless "
      "--no-sandbox --disable-gpu --enable-logging=stderr --user-data-dir=" +
      quoted("profile") + " --dump-dom 'file://" + (folder / "report.html").string() + "' >" + quoted("page") + " 2>" +
      quoted("console");
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(folder / "page"), read(folder / "console")};
}

TEST(ReportInABrowser, ShowsItsFindingsAndDrawsItsViewWithoutAComplaint) {
  ReportContent content = test::visit();
  content.anomalies = {test::finding(3, 40.0), test::finding(4, 80.0)};
  content.crops[3] = cv::Mat(20, 30, CV_8UC1, cv::Scalar(7));
  const Shown page = shown(report_html(content, test::run_json()));
  ASSERT_EQ(page.status, 0) << page.console;
  EXPECT_THAT(page.page, HasSubstr("<b>2 places</b> became abnormally hot"));
  EXPECT_THAT(page.page, HasSubstr("Finding 4"));
  EXPECT_THAT(page.page, HasSubstr("<span id=\"view3d-m\">1.0 m</span>")) << "the script did not reach its end";
  EXPECT_THAT(page.console, Not(HasSubstr("CONSOLE")));
}

TEST(ReportInABrowser, AMistakeInAScriptWouldBeNoticed) {
  EXPECT_THAT(shown("<script>nothing.here()</script>").console, HasSubstr("CONSOLE"));
}

}  // namespace
}  // namespace pllit
