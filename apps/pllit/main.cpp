// pllit VERB ...: parses the command line and hands over to the verb. Results go to stdout, everything else to stderr.
#include <malloc.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "program.hpp"

namespace pllit::app {
namespace {

constexpr const char* kFooter = R"(Examples:
  pllit doctor drive.bag --config kitti               what a recording holds and whether it can be run
  pllit run drive.bag --config kitti                  trajectory, map and health record in results/latest
  pllit config --dump kitti > my.yaml                 a complete, commented configuration to edit
  pllit eval truth.tum results/latest/trajectory.tum  how far the estimate is from the truth
  pllit export results/latest --format las            the map for a surveyor

`pllit VERB --help` explains a verb. Exit codes: 0 done, 1 failed or interrupted, 2 wrong usage,
configuration or input, 3 finished but degraded or lost, 4 anomalies at or above the alarm level.)";

int code(ExitCode exit_code) { return static_cast<int>(exit_code); }

/// Clouds and images come and go ten times a second. What they leave is kept for the next ones: taking it from the
/// kernel page by page every time costs a tenth of a frame.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kMegabyte = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 * kMegabyte);
  mallopt(M_TRIM_THRESHOLD, 128 * kMegabyte);
#endif
}

void log_to_stderr() {
  spdlog::set_default_logger(spdlog::stderr_color_mt("pllit"));
  spdlog::set_pattern("%^%l%$: %v");
}

void set_log_level(std::size_t verbose, bool quiet) {
  spdlog::set_level(quiet ? spdlog::level::err : verbose > 0 ? spdlog::level::debug : spdlog::level::info);
}

int wrong_usage(const std::string& message) {
  spdlog::error("{}", message);
  std::fputs("See: pllit --help\n", stderr);
  return code(ExitCode::usage);
}

/// Help and version are results; every other outcome of parsing is wrong usage.
int finish_parsing(const CLI::App& program, const CLI::ParseError& outcome, int argc, const char* const* argv) {
  if (outcome.get_exit_code() == 0) return program.exit(outcome);
  const std::string suggestion = suggestion_for(program, argc, argv);
  return wrong_usage(suggestion.empty() ? outcome.what() : suggestion);
}

int run(int argc, char** argv) {
  CLI::App program("LiDAR, IMU and thermal camera: where the rig went, what the place looks like, what has become hot.",
                   "pllit");
  program.require_subcommand(1);
  program.footer(kFooter);
  program.set_version_flag("--version", version_line, "Print version and commit");
  bool quiet = false;
  const CLI::Option* verbose = program.add_flag("-v,--verbose", "Log more");
  program.add_flag("-q,--quiet", quiet, "Log errors only");
  const std::vector<Verb> verbs = {add_run(program),    add_simulate(program), add_doctor(program),
                                   add_eval(program),   add_export(program),   add_compare(program),
                                   add_trends(program), add_config(program)};
  for (const Verb& verb : verbs) verb.command->fallthrough();  // -v and -q hold after the verb as well
  if (const std::string complaint = complaint_about_empty(argc, argv); !complaint.empty())
    return wrong_usage(complaint);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& outcome) {
    return finish_parsing(program, outcome, argc, argv);
  }
  set_log_level(verbose->count(), quiet);
  const auto chosen = std::ranges::find_if(verbs, [](const Verb& verb) { return verb.command->parsed(); });
  return code(chosen->run());
}

}  // namespace
}  // namespace pllit::app

int main(int argc, char** argv) {
  using namespace pllit::app;
  log_to_stderr();
  keep_freed_memory();
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit then shows as a failed write, like a full disk
  try {
    const int exit_code = run(argc, argv);
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
    spdlog::error("the results could not be written to stdout");
  } catch (const std::exception& error) {
    spdlog::critical("{}; this is a fault of the program, please report it with the command line", error.what());
  }
  return code(ExitCode::failed);
}
