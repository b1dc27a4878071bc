#include "run_program.hpp"

namespace pllit {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class Program : public test::ProgramTest {};

TEST_F(Program, PrintsHelpWithExamplesOnStdout) {
  const auto [exit_code, out, err] = run({"--help"});
  EXPECT_EQ(exit_code, 0);
  EXPECT_THAT(out, AllOf(HasSubstr("Examples:"), HasSubstr("pllit config --dump"), HasSubstr("Exit codes")));
  EXPECT_THAT(err, IsEmpty());
}

TEST_F(Program, ExplainsEveryVerbWithAnExample) {
  for (const char* verb : {"compare", "config", "eval", "export", "trends"}) {
    const auto [exit_code, out, err] = run({verb, "--help"});
    EXPECT_EQ(exit_code, 0) << verb;
    EXPECT_THAT(out, HasSubstr(std::string("  pllit ") + verb));
    EXPECT_THAT(err, IsEmpty());
  }
}

TEST_F(Program, PrintsVersionAndCommit) {
  const auto [exit_code, out, err] = run({"--version"});
  EXPECT_EQ(exit_code, 0);
  EXPECT_THAT(out,
              AllOf(StartsWith("pllit 0."), ContainsRegex("\\([0-9a-f]{12}\\)|\\(not built from a git repository\\)")));
}

TEST_F(Program, RefusesWrongUsageWithExitCodeTwoOnStderrOnly) {
  const std::vector<std::vector<std::string>> wrong{
      {}, {"evla"}, {"config"}, {"config", "--dmup"}, {"eval", "one.tum"}, {"--set"}};
  for (const auto& arguments : wrong) {
    const auto [exit_code, out, err] = run(arguments);
    EXPECT_EQ(exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(out, IsEmpty()) << testing::PrintToString(arguments);
    EXPECT_THAT(err, ContainsRegex("pllit (config )?--help")) << testing::PrintToString(arguments);
  }
}

TEST_F(Program, SuggestsTheVerbOrOptionThatWasMeant) {
  EXPECT_THAT(run({"evla"}).err, HasSubstr("Unknown verb 'evla'; did you mean 'eval'?"));
  EXPECT_THAT(run({"config", "--dmup"}).err, HasSubstr("Unknown option '--dmup'; did you mean '--dump'?"));
  EXPECT_THAT(run({"-v", "export", "--foramt=las"}).err, HasSubstr("did you mean '--format'?"));
}

TEST_F(Program, RefusesAnEmptyValueThatAShellVariableLeft) {
  EXPECT_EQ(run({"run", "sim:box_room", "--config", ""}).exit_code, 2);
  EXPECT_THAT(run({"run", "sim:box_room", "--config", ""}).err, HasSubstr("The value of --config is empty"));
  EXPECT_THAT(run({"run", "sim:box_room", "--config="}).err, HasSubstr("--config has no value"));
  EXPECT_EQ(run({"config", "--dump", "--set=advanced.report.severity="}).exit_code, 0);
  EXPECT_THAT(run({"eval", "", "estimate.tum"}).err, HasSubstr("Argument 2 is empty"));
}

TEST_F(Program, TakesVerbosityBeforeAndAfterTheVerb) {
  EXPECT_EQ(run({"-q", "config", "--presets"}).exit_code, 0);
  EXPECT_EQ(run({"config", "--presets", "-v"}).exit_code, 0);
}

TEST_F(Program, FailsWhereItsResultsCannotBeWritten) {
  const std::string full = "/dev/full";
  if (!std::filesystem::exists(full)) GTEST_SKIP() << "no " << full;
  const int status =
      std::system((std::string("'") + PLLIT_PROGRAM + "' config --dump >" + full + " 2>/dev/null").c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
}

}  // namespace
}  // namespace pllit
